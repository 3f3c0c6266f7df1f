#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/estimate.h"
#include "tests/pbrt/scene_folder.h"
#include "worker/integrator/render.h"

// Scenes at the edge of what numbers hold, written as pbrt text, rendered by the worker's renderer
// and merged by the coordinator's film.

namespace strata {

struct RenderOptions {
  int size = 16;  ///< The frame is square.
  uint32_t spp = 64;
  int max_depth = 5;
  uint64_t seed = 1;
  DirectStrategy direct = DirectStrategy::kMis;
};

/// What a finished job shows.
struct Picture {
  std::vector<PixelEstimate> pixels;  ///< Row-major.
  std::vector<double> depth;          ///< The channel depth.Z.
  uint64_t samples = 0, rays = 0, nonfinite = 0;
};

/// The folder's scene.pbrt, ready to be traced.
std::shared_ptr<const Scene> LoadFolder(const SceneFolder& folder);
Picture Render(std::shared_ptr<const Scene> scene, const RenderOptions& options);
/// Of a single file.
Picture Render(const std::string& text, const RenderOptions& options);

/// A file with a camera at `eye` that looks at `look`, with the up vector z, and this world.
std::string SceneText(const std::string& eye, const std::string& look, double fov,
                      const std::string& world);
/// The shape of a plane mesh: the corners of triangles, three numbers each, in threes.
std::string Triangles(const std::vector<double>& corners);

/// The mean of all pixels with its standard error.
struct FrameMean {
  double mean = 0, standard_error = 0;
};
FrameMean MeanOf(const Picture& picture, int channel = 1);

/// Expects the frame's mean of green within 4.4 standard errors (p = 1e-5; the eight replicates of
/// many pixels make them nearly normal) and a relative rounding of `rounding` of the truth, and no
/// sample that is not finite. As a control the same must not hold of a truth that is larger by the
/// part `detectable`. Prints and records the relative error under `name`.
void ExpectMean(const std::string& name, const Picture& picture, double truth, double rounding,
                double detectable);
/// The same for two pictures, and their control.
void ExpectSameMean(const std::string& name, const Picture& a, const Picture& b, double rounding,
                    double detectable);
/// Expects every pixel's green to be the truth but for `rounding`, relative, and no sample that is
/// not finite: for scenes without noise. Prints and records the largest relative error.
void ExpectEveryPixel(const std::string& name, const Picture& picture, double truth,
                      double rounding);

/// Prints a figure and makes it a property of the test's report.
void Report(const std::string& name, double figure);

}  // namespace strata
