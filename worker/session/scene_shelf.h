#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <utility>

#include "common/digest.h"
#include "worker/session/render_engine.h"

namespace strata {

/// Bytes of memory this process occupies now.
uint64_t ResidentBytes();

/// The scenes a worker keeps, those used last first. Jobs that render one share it, so what is
/// dropped here lives until they let go. Not thread-safe.
class SceneShelf {
 public:
  /// `memory_limit` in bytes; 0: none.
  explicit SceneShelf(uint64_t memory_limit) : memory_limit_(memory_limit) {}

  /// The scene of this bundle, now used last; null if it is not kept.
  std::shared_ptr<const LoadedScene> Find(const Digest& bundle);
  void Put(const Digest& bundle, std::shared_ptr<const LoadedScene> scene);
  /// Drops the scenes used longest ago while the process occupies more than the limit. False when
  /// the limit is exceeded even so; then none is kept.
  bool MakeRoom();

  static constexpr size_t kScenes = 4;

 private:
  const uint64_t memory_limit_;
  std::list<std::pair<Digest, std::shared_ptr<const LoadedScene>>> scenes_;
};

}  // namespace strata
