#include "worker/geometry/loop_subdivision.h"

#include <absl/container/flat_hash_map.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

constexpr int32_t kNoHalfEdge = -1;
using SubdivisionFace = std::array<uint32_t, 3>;

/// A triangle mesh with its neighbourhoods. Half-edge 3 f + i goes along face f from its vertex i
/// to the next; its twin goes along the neighbouring face, the other way.
class SubdivisionSurface {
 public:
  static absl::StatusOr<SubdivisionSurface> Create(std::vector<Vec3d> positions,
                                                   std::vector<SubdivisionFace> faces);

  /// One step of refinement.
  SubdivisionSurface Refined() const;
  /// Vertices moved to the limit, with their normals.
  TriangleMeshShape Limit() const;

 private:
  /// The vertices around one, counter-clockwise; on a border from one neighbour on it to the other.
  struct Ring {
    std::vector<Vec3d> p;
    bool is_border = false;

    double Valence() const { return static_cast<double>(p.size()); }
    Vec3d Sum() const {
      Vec3d sum;
      for (const Vec3d& q : p) sum = sum + q;
      return sum;
    }
  };

  static int32_t Next(int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int32_t Previous(int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  uint32_t Origin(int32_t h) const { return faces_[h / 3][h % 3]; }
  uint32_t Target(int32_t h) const { return Origin(Next(h)); }

  absl::Status Connect();
  Ring RingOf(uint32_t vertex) const;
  Vec3d Refine(uint32_t vertex) const;
  Vec3d PointOnEdge(int32_t h) const;
  Vec3d LimitOf(Vec3d p, const Ring& ring) const;
  static Vec3d NormalOf(Vec3d p, const Ring& ring);

  std::vector<Vec3d> positions_;
  std::vector<SubdivisionFace> faces_;
  std::vector<int32_t> twins_;  ///< Of each half-edge; kNoHalfEdge on a border.
  /// A half-edge from each vertex, on a border the one without a twin; kNoHalfEdge: of no face.
  std::vector<int32_t> outgoing_;
};

/// The weight of each neighbour of an inner vertex (Warren).
double Beta(double valence) { return valence == 3 ? 3.0 / 16 : 3 / (8 * valence); }

/// Of a border's vertex, whose neighbours on it weigh `weight` each.
Vec3d OnBorder(Vec3d p, Vec3d before, Vec3d after, double weight) {
  return p * (1 - 2 * weight) + (before + after) * weight;
}

absl::StatusOr<SubdivisionSurface> SubdivisionSurface::Create(std::vector<Vec3d> positions,
                                                              std::vector<SubdivisionFace> faces) {
  SubdivisionSurface surface;
  surface.positions_ = std::move(positions);
  surface.faces_ = std::move(faces);
  STRATA_RETURN_IF_ERROR(surface.Connect());
  return surface;
}

absl::Status SubdivisionSurface::Connect() {
  absl::flat_hash_map<uint64_t, int32_t> edges;
  const int32_t count = static_cast<int32_t>(3 * faces_.size());
  edges.reserve(count);
  const auto key = [](uint32_t from, uint32_t to) { return uint64_t{from} << 32 | to; };
  for (int32_t h = 0; h < count; ++h) {
    const uint32_t from = Origin(h), to = Target(h);
    if (from == to)
      return absl::InvalidArgumentError(
          absl::StrCat("a face of the mesh has vertex ", from, " twice"));
    if (!edges.try_emplace(key(from, to), h).second)
      return absl::InvalidArgumentError(
          absl::StrCat("the edge between vertices ", from, " and ", to,
                       " has more than two faces, or two that are not oriented alike"));
  }
  twins_.assign(count, kNoHalfEdge);
  outgoing_.assign(positions_.size(), kNoHalfEdge);
  std::vector<int32_t> faces_around(positions_.size(), 0);
  for (int32_t h = 0; h < count; ++h) {
    const auto twin = edges.find(key(Target(h), Origin(h)));
    if (twin != edges.end()) twins_[h] = twin->second;
    ++faces_around[Origin(h)];
    if (outgoing_[Origin(h)] == kNoHalfEdge || twins_[h] == kNoHalfEdge) outgoing_[Origin(h)] = h;
  }
  for (uint32_t v = 0; v < positions_.size(); ++v) {
    if (outgoing_[v] == kNoHalfEdge) continue;
    int32_t walked = 0, h = outgoing_[v];
    do {
      ++walked;
      h = twins_[Previous(h)];
    } while (h != kNoHalfEdge && h != outgoing_[v] && walked <= faces_around[v]);
    if (walked != faces_around[v])
      return absl::InvalidArgumentError(
          absl::StrCat("faces of the mesh meet in vertex ", v, " alone; give each part its own"));
  }
  return absl::OkStatus();
}

SubdivisionSurface::Ring SubdivisionSurface::RingOf(uint32_t vertex) const {
  Ring ring;
  int32_t h = outgoing_[vertex];
  do {
    ring.p.push_back(positions_[Target(h)]);
    const int32_t before = Previous(h);
    h = twins_[before];
    if (h == kNoHalfEdge) {
      ring.is_border = true;
      ring.p.push_back(positions_[Origin(before)]);
    }
  } while (h != kNoHalfEdge && h != outgoing_[vertex]);
  return ring;
}

Vec3d SubdivisionSurface::Refine(uint32_t vertex) const {
  const Vec3d p = positions_[vertex];
  if (outgoing_[vertex] == kNoHalfEdge) return p;
  const Ring ring = RingOf(vertex);
  if (ring.is_border) return OnBorder(p, ring.p.front(), ring.p.back(), 1.0 / 8);
  const double beta = Beta(ring.Valence());
  return p * (1 - ring.Valence() * beta) + ring.Sum() * beta;
}

Vec3d SubdivisionSurface::PointOnEdge(int32_t h) const {
  const Vec3d ends = positions_[Origin(h)] + positions_[Target(h)];
  if (twins_[h] == kNoHalfEdge) return ends * 0.5;
  const Vec3d across = positions_[Origin(Previous(h))] + positions_[Origin(Previous(twins_[h]))];
  return ends * (3.0 / 8) + across * (1.0 / 8);
}

SubdivisionSurface SubdivisionSurface::Refined() const {
  SubdivisionSurface fine;
  fine.positions_.reserve(positions_.size() + 2 * faces_.size());
  for (uint32_t v = 0; v < positions_.size(); ++v) fine.positions_.push_back(Refine(v));
  std::vector<uint32_t> middles(twins_.size());
  for (int32_t h = 0; h < static_cast<int32_t>(twins_.size()); ++h) {
    if (twins_[h] != kNoHalfEdge && twins_[h] < h) {
      middles[h] = middles[twins_[h]];
      continue;
    }
    middles[h] = static_cast<uint32_t>(fine.positions_.size());
    fine.positions_.push_back(PointOnEdge(h));
  }
  fine.faces_.reserve(4 * faces_.size());
  for (size_t f = 0; f < faces_.size(); ++f) {
    const SubdivisionFace& v = faces_[f];
    const uint32_t* m = &middles[3 * f];
    for (const SubdivisionFace& face :
         {SubdivisionFace{v[0], m[0], m[2]}, SubdivisionFace{m[0], v[1], m[1]},
          SubdivisionFace{m[2], m[1], v[2]}, SubdivisionFace{m[0], m[1], m[2]}})
      fine.faces_.push_back(face);
  }
  // A refined surface is one, too.
  (void)fine.Connect();
  return fine;
}

Vec3d SubdivisionSurface::LimitOf(Vec3d p, const Ring& ring) const {
  if (ring.is_border) return OnBorder(p, ring.p.front(), ring.p.back(), 1.0 / 6);
  const double gamma = 1 / (ring.Valence() + 3 / (8 * Beta(ring.Valence())));
  return p * (1 - ring.Valence() * gamma) + ring.Sum() * gamma;
}

/// By the two tangents of the limit surface, which are sums over the ring.
Vec3d SubdivisionSurface::NormalOf(Vec3d p, const Ring& ring) {
  const std::vector<Vec3d>& q = ring.p;
  const size_t n = q.size();
  Vec3d along, inwards;
  if (!ring.is_border) {
    for (size_t i = 0; i < n; ++i) {
      const auto [sin, cos] =
          SinCos(2 * std::numbers::pi * static_cast<double>(i) / ring.Valence());
      along = along + q[i] * cos;
      inwards = inwards + q[i] * sin;
    }
  } else {
    along = q.front() - q.back();
    if (n == 2) {
      inwards = q[0] + q[1] - p * 2;
    } else if (n == 3) {
      inwards = q[1] - p;
    } else if (n == 4) {
      inwards = q[1] * 2 + q[2] * 2 - q[0] - q[3] - p * 2;
    } else {
      const double angle = std::numbers::pi / (ring.Valence() - 1);
      const auto [sin, cos] = SinCos(angle);
      inwards = (q.front() + q.back()) * -sin;
      for (size_t i = 1; i + 1 < n; ++i)
        inwards = inwards + q[i] * ((2 - 2 * cos) * Sin(static_cast<double>(i) * angle));
    }
  }
  return Cross(along, inwards);
}

TriangleMeshShape SubdivisionSurface::Limit() const {
  TriangleMeshShape mesh;
  for (uint32_t v = 0; v < positions_.size(); ++v) {
    const Vec3d p = positions_[v];
    const Ring ring = outgoing_[v] == kNoHalfEdge ? Ring{} : RingOf(v);
    const Vec3d normal = ring.p.empty() ? Vec3d{} : NormalOf(p, ring);
    mesh.positions.push_back(ToFloat(ring.p.empty() ? p : LimitOf(p, ring)));
    mesh.normals.push_back(ToFloat(Dot(normal, normal) > 0 ? Normalize(normal) : Vec3d{}));
  }
  mesh.triangles = faces_;
  return mesh;
}

}  // namespace

absl::StatusOr<TriangleMeshShape> LoopSubdivide(const TriangleMeshShape& control, int levels) {
  constexpr double kMaxFaces = 0x1p29;  // Half-edges are counted in 31 bits.
  if (levels < 0 ||
      static_cast<double>(control.triangles.size()) * std::ldexp(1, 2 * levels) > kMaxFaces)
    return absl::InvalidArgumentError(
        absl::StrCat("subdivision by ", levels, " levels gives too many faces; give fewer levels"));
  for (const SubdivisionFace& face : control.triangles) {
    for (const uint32_t index : face) {
      if (index >= control.positions.size())
        return absl::InvalidArgumentError(absl::StrCat("the mesh refers to vertex ", index,
                                                       " but has ", control.positions.size()));
    }
  }
  std::vector<Vec3d> positions;
  for (const Vec3f& p : control.positions) positions.push_back(ToDouble(p));
  STRATA_ASSIGN_OR_RETURN(SubdivisionSurface surface,
                          SubdivisionSurface::Create(std::move(positions), control.triangles));
  for (int level = 0; level < levels; ++level) surface = surface.Refined();
  return surface.Limit();
}

}  // namespace strata
