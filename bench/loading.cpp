// How long a large scene takes from its files to the first ray, and how much memory: a height field
// as one binary PLY, read, built and ready.

#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// What one load took, in a process of its own.
struct Load {
  double seconds = 0;
  uint64_t triangles = 0;
  double peak_bytes = 0;  ///< Resident, at most, less the process before it loaded.
};

/// Appends the bytes of `values`.
template <typename T>
void Append(std::string* bytes, std::initializer_list<T> values) {
  for (const T value : values) bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// A field of edge x edge vertices with normals and texture coordinates, little-endian.
void WriteHeightField(const fs::path& path, int edge) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << edge * edge
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
          "property float ny\nproperty float nz\nproperty float u\nproperty float v\nelement face "
       << 2 * (edge - 1) * (edge - 1) << "\nproperty list uchar int vertex_indices\nend_header\n";
  std::string row;
  for (int y = 0; y < edge; ++y) {
    row.clear();
    for (int x = 0; x < edge; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(edge - 1);
      const float v = static_cast<float>(y) / static_cast<float>(edge - 1);
      const float z = 0.02f * std::sin(40 * u) * std::cos(30 * v) + 0.003f * std::sin(700 * u * v);
      Append<float>(&row, {u, v, z, 0, 0, 1, u, v});
    }
    file << row;
  }
  for (int y = 0; y + 1 < edge; ++y) {
    row.clear();
    for (int x = 0; x + 1 < edge; ++x) {
      const int32_t corner = y * edge + x;
      for (const auto& [a, b, c] : {std::array{corner, corner + 1, corner + edge + 1},
                                    std::array{corner, corner + edge + 1, corner + edge}}) {
        row.push_back(3);
        Append<int32_t>(&row, {a, b, c});
      }
    }
    file << row;
  }
}

void WriteScene(const fs::path& folder, int edge) {
  WriteHeightField(folder / "field.ply", edge);
  std::ofstream(folder / "scene.pbrt")
      << "LookAt 0.5 -1 1  0.5 0.5 0  0 0 1\nCamera \"perspective\" \"float fov\" 45\nWorldBegin\n"
         "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\nMaterial \"diffuse\"\n"
         "Shape \"plymesh\" \"string filename\" \"field.ply\"\n";
}

double PeakBytes() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// Loads the scene and writes what it took to `to`.
int LoadOnce(const fs::path& folder, int to) {
  Load load;
  const double before = PeakBytes();
  const auto start = std::chrono::steady_clock::now();
  const auto scene = LoadScene(DirectorySource(folder), "scene.pbrt");
  load.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!scene.ok()) {
    std::fprintf(stderr, "%s\n", scene.status().ToString().c_str());
    return 1;
  }
  load.triangles = (*scene)->geometry().triangle_count();
  load.peak_bytes = PeakBytes() - before;
  return write(to, &load, sizeof(load)) == sizeof(load) ? 0 : 1;
}

/// In a process of its own, since the peak of this one would not fall again.
bool LoadElsewhere(const fs::path& folder, Load* load) {
  int ends[2];
  if (pipe(ends) != 0) return false;
  const pid_t child = fork();
  if (child == 0) _exit(LoadOnce(folder, ends[1]));
  close(ends[1]);
  const bool told = child > 0 && read(ends[0], load, sizeof(*load)) == sizeof(*load);
  close(ends[0]);
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0 && told;
}

int Main(int argc, char** argv) {
  CLI::App app("Seconds and memory to load a height field of many triangles");
  double millions = 3.5;
  int repeats = 5;
  app.add_option("--millions", millions, "of triangles")->check(CLI::Range(0.001, 500.0));
  app.add_option("--repeats", repeats)->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);

  std::string name = (fs::temp_directory_path() / "strata-loading-XXXXXX").string();
  if (!mkdtemp(name.data())) {
    std::perror(name.c_str());
    return 2;
  }
  const fs::path folder = name;
  WriteScene(folder, static_cast<int>(std::lround(std::sqrt(millions * 1e6 / 2))) + 1);
  std::vector<Load> loads(static_cast<size_t>(repeats));
  bool good = true;
  for (Load& load : loads) good = good && LoadElsewhere(folder, &load);
  fs::remove_all(folder);
  if (!good) return 2;
  std::sort(loads.begin(), loads.end(),
            [](const Load& a, const Load& b) { return a.seconds < b.seconds; });
  const Load& median = loads[loads.size() / 2];
  std::printf("%.2f million triangles: %.2f s (%.2f..%.2f), at most %.0f MB, %.0f bytes each\n",
              static_cast<double>(median.triangles) * 1e-6, median.seconds, loads.front().seconds,
              loads.back().seconds, median.peak_bytes * 1e-6,
              median.peak_bytes / static_cast<double>(median.triangles));
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
