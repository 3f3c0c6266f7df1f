#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "common/bundle.h"
#include "common/job.h"
#include "common/kernel_revision.h"
#include "common/status.h"
#include "common/unit.h"
#include "worker/scene/build_options.h"
#include "worker/scene/file_source.h"

namespace strata {

/// A scene ready to be traced: geometry, lights, materials, textures, camera-independent.
class Scene;

/// Reads the bundle's scene from `source` and builds it.
absl::StatusOr<std::shared_ptr<const Scene>> LoadScene(const FileSource& source,
                                                       const std::string& scene_path,
                                                       const BuildOptions& build_options = {},
                                                       const SceneOptions& scene_options = {});

/// Threads that share the pixels of one unit at a time. Not thread-safe itself.
class RenderPool {
 public:
  explicit RenderPool(int threads);
  ~RenderPool();
  int threads() const;

 private:
  friend class Renderer;
  struct State;
  std::unique_ptr<State> state_;
};

/// Renders units of one job. Immutable and thread-safe but for `pool`.
class Renderer {
 public:
  /// INVALID_ARGUMENT when the spec cannot be rendered with this scene. Strategies other than
  /// kMis, its other exponents and routines other than kPreserving are for comparisons: the
  /// reference kernel alone knows them, and renders them for either.
  /// Roulette by efficiency traces its pilot here.
  static absl::StatusOr<std::unique_ptr<Renderer>> Create(std::shared_ptr<const Scene> scene,
                                                          const JobSpec& spec);
  ~Renderer();

  /// The same bits for any pool. CANCELLED soon after `*cancel` becomes true.
  absl::StatusOr<Partial> Render(const WorkUnit& unit, RenderPool& pool,
                                 const std::atomic<bool>* cancel = nullptr) const;

  /// Pixels of the job whose rays surely meet nothing, so that none are traced.
  int64_t BackgroundPixels() const;

  /// One path told vertex by vertex, for `strata replay`.
  std::string Replay(int x, int y, uint32_t replicate, uint32_t sample) const;

  struct State;  ///< worker/integrator/renderer_state.h

 private:
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Digest of a small built-in scene rendered by every compiled kernel: equal on machines whose
/// renders are equal (design, section 4). Takes some milliseconds.
Digest TracedDigest();

}  // namespace strata
