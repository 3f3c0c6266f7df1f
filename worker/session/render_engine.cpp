#include "worker/session/render_engine.h"

#include <utility>

#include "worker/integrator/render.h"

namespace strata {
namespace {

struct TracedScene final : LoadedScene {
  explicit TracedScene(std::shared_ptr<const Scene> s) : scene(std::move(s)) {}
  std::shared_ptr<const Scene> scene;
};

class PathTracer final : public UnitRenderer {
 public:
  PathTracer(std::unique_ptr<Renderer> renderer, std::shared_ptr<RenderPool> pool)
      : renderer_(std::move(renderer)), pool_(std::move(pool)) {}

  absl::StatusOr<Partial> Render(const WorkUnit& unit, const std::atomic<bool>& cancel) override {
    return renderer_->Render(unit, *pool_, &cancel);
  }
  int64_t BackgroundPixels() const override { return renderer_->BackgroundPixels(); }

 private:
  std::unique_ptr<Renderer> renderer_;
  std::shared_ptr<RenderPool> pool_;
};

class PathTracingEngine final : public RenderEngine {
 public:
  explicit PathTracingEngine(int threads) : pool_(std::make_shared<RenderPool>(threads)) {}

  absl::StatusOr<std::shared_ptr<const LoadedScene>> Load(const FileSource& source,
                                                          const Bundle& bundle) override {
    STRATA_ASSIGN_OR_RETURN(std::shared_ptr<const Scene> scene,
                            LoadScene(source, bundle.scene, {}, bundle.options));
    return std::make_shared<const TracedScene>(std::move(scene));
  }

  absl::StatusOr<std::unique_ptr<UnitRenderer>> Prepare(std::shared_ptr<const LoadedScene> scene,
                                                        const JobSpec& spec) override {
    const auto& traced = static_cast<const TracedScene&>(*scene);
    STRATA_ASSIGN_OR_RETURN(std::unique_ptr<Renderer> renderer,
                            Renderer::Create(traced.scene, spec));
    return std::make_unique<PathTracer>(std::move(renderer), pool_);
  }

 private:
  std::shared_ptr<RenderPool> pool_;
};

}  // namespace

std::unique_ptr<RenderEngine> NewPathTracingEngine(int threads) {
  return std::make_unique<PathTracingEngine>(threads);
}

}  // namespace strata
