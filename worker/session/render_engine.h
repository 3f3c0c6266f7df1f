#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "common/job.h"
#include "common/status.h"
#include "common/unit.h"
#include "worker/scene/file_source.h"

namespace strata {

/// A scene some engine has loaded; jobs share it.
class LoadedScene {
 public:
  virtual ~LoadedScene() = default;
};

/// Renders the units of one job.
class UnitRenderer {
 public:
  virtual ~UnitRenderer() = default;
  /// A pure function of scene, spec and unit. CANCELLED soon after `cancel` becomes true.
  virtual absl::StatusOr<Partial> Render(const WorkUnit& unit, const std::atomic<bool>& cancel) = 0;
  /// Pixels of the job's crop in which no rays are traced, since they see the background only.
  virtual int64_t BackgroundPixels() const { return 0; }
};

/// What a session renders with: the real renderer, or a small one in tests. A session calls Load
/// and Prepare from one thread and Render from another.
class RenderEngine {
 public:
  virtual ~RenderEngine() = default;
  /// Loads the bundle's scene, whose files `source` has, as its options say. INVALID_ARGUMENT or
  /// NOT_FOUND when the fault is the scene's.
  virtual absl::StatusOr<std::shared_ptr<const LoadedScene>> Load(const FileSource& source,
                                                                  const Bundle& bundle) = 0;
  /// INVALID_ARGUMENT when the spec cannot be rendered with this scene.
  virtual absl::StatusOr<std::unique_ptr<UnitRenderer>> Prepare(
      std::shared_ptr<const LoadedScene> scene, const JobSpec& spec) = 0;
};

/// The path tracer on `threads` threads.
std::unique_ptr<RenderEngine> NewPathTracingEngine(int threads);

}  // namespace strata
