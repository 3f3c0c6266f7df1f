#include <string>

#include "absl/strings/str_format.h"
#include "worker/integrator/renderer_state.h"

namespace strata {
namespace {

std::string Text(Rgb c) { return absl::StrFormat("(%.6g %.6g %.6g)", c.r, c.g, c.b); }
std::string Text(Vec3f v) { return absl::StrFormat("(%.6g %.6g %.6g)", v.x, v.y, v.z); }

/// A position in the file's world.
std::string PositionText(Vec3d origin, Vec3f p) {
  return absl::StrFormat("(%.9g %.9g %.9g)", origin.x + p.x, origin.y + p.y, origin.z + p.z);
}

/// Writes down every event of a path, a line each.
class ReplayObserver {
 public:
  /// `origin` is the scene's.
  ReplayObserver(Vec3d origin, std::string* text) : origin_(origin), text_(text) {}

  void OnFlight(const Flight& flight) {
    absl::StrAppendFormat(
        text_, "through media, %s in %s: weight %s",
        flight.scattered ? absl::StrFormat("scattered after %.6g", flight.t) : "not scattered",
        flight.medium == kNoMedium ? "none" : absl::StrFormat("medium %d", flight.medium),
        Text(flight.weight));
    if (!IsBlack(flight.emitted))
      absl::StrAppendFormat(text_, ", emitted %s", Text(flight.emitted));
    absl::StrAppend(text_, "\n");
  }
  void OnMiss(const Ray& ray, Rgb radiance, float weight) {
    absl::StrAppendFormat(text_, "leaves the scene towards %s: environment %s, MIS weight %.6g\n",
                          Text(ray.direction), Text(radiance), weight);
  }
  void OnVertex(int depth, const Ray& ray, const PathVertex& vertex, Rgb beta) {
    const SurfacePoint& point = vertex.point;
    if (vertex.in_medium) {
      absl::StrAppendFormat(text_,
                            "vertex %d at %s, in a medium, reached from %s\n"
                            "  throughput %s\n",
                            depth, InFile(point.p), InFile(ray.origin), Text(beta));
      return;
    }
    absl::StrAppendFormat(text_,
                          "vertex %d at %s, reached from %s\n"
                          "  material %d, normal %s, shading normal %s, uv (%.6g %.6g)\n"
                          "  throughput %s\n",
                          depth, InFile(point.p), InFile(ray.origin), point.material,
                          Text(point.ng), Text(vertex.frame.z), point.uv.x, point.uv.y, Text(beta));
  }
  void OnEmission(uint32_t light, Rgb radiance, float weight) {
    absl::StrAppendFormat(text_, "meets light %d: emits %s, MIS weight %.6g\n", light,
                          Text(radiance), weight);
  }
  void OnLight(const DirectSample& direct, Rgb contribution) {
    absl::StrAppendFormat(text_,
                          "  light %d (chosen with %.6g): towards %s, radiance %s, pdf %.6g%s\n"
                          "    BSDF x cosine %s, its pdf %.6g, MIS weight %.6g: %s %s\n",
                          direct.choice.light, direct.choice.probability, Text(direct.light.wi),
                          Text(direct.light.radiance), direct.light.pdf,
                          direct.light.delta ? " (delta)" : "", Text(direct.f), direct.bsdf_pdf,
                          direct.weight,
                          !direct.traced   ? "adds little, roulette leaves it out,"
                          : direct.blocked ? "blocked, adds"
                                           : "adds",
                          Text(contribution));
    if (direct.transmittance != Rgb{1, 1, 1})
      absl::StrAppendFormat(text_, "    transmittance of media: %s\n", Text(direct.transmittance));
    if (direct.survival < 1)
      absl::StrAppendFormat(text_, "    roulette of the shadow ray: survival %.6g\n",
                            direct.survival);
  }
  void OnBsdf(const std::optional<BsdfSample>& sample, Vec3f wi_world) {
    if (!sample) {
      absl::StrAppend(text_, "  BSDF: absorbed\n");
      return;
    }
    absl::StrAppendFormat(text_, "  BSDF: %s towards %s, pdf %.6g%s, weight %s\n",
                          sample->transmission ? "transmitted" : "reflected", Text(wi_world),
                          sample->pdf, sample->delta ? " (delta)" : "", Text(sample->weight));
  }
  void OnRoulette(float survival, bool survived) {
    absl::StrAppendFormat(text_, "  roulette: survival %.6g, %s\n", survival,
                          survived ? "goes on" : "ends");
  }

 private:
  std::string InFile(Vec3f p) const { return PositionText(origin_, p); }

  Vec3d origin_;
  std::string* text_;
};

}  // namespace

template <typename Sampler>
std::string Renderer::State::ReplaySample(int x, int y, uint32_t replicate, uint32_t sample) const {
  Sampler sampler(Key(x, y, replicate));
  sampler.StartSample(sample);
  float weight = 1;
  const Ray ray = CameraRay(x, y, sampler, &weight);
  std::string text = absl::StrFormat(
      "pixel (%d, %d), replicate %d, sample %d, seed %d, frame %d\n"
      "camera ray from %s towards %s, filter weight %.6g\n",
      x, y, replicate, sample, spec.seed, spec.frame, PositionText(scene->origin(), ray.origin),
      Text(ray.direction), weight);
  if (moves) absl::StrAppendFormat(&text, "time of motion %.6g\n", ray.time);
  ReplayObserver observer(scene->origin(), &text);
  const PathSettings settings_here = SettingsAt(x, y);
  const PathSample result = PathTracer(*scene, settings_here, sampler, observer).Trace(ray);
  const Rgb value = result.radiance * weight;
  absl::StrAppendFormat(&text, "value %s from %d rays%s\n", Text(value), result.rays,
                        IsFinite(value) ? "" : ": not finite, enters the pixel as zero");
  return text;
}

std::string Renderer::Replay(int x, int y, uint32_t replicate, uint32_t sample) const {
  return WithSampler(state_->spec.sampler, [&]<typename Sampler>() {
    return state_->ReplaySample<Sampler>(x, y, replicate, sample);
  });
}

}  // namespace strata
