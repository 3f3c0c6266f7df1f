#include "worker/service/health_file.h"

#include <spdlog/spdlog.h>

#include <fstream>
#include <string>

#include "worker/service/worker_client.h"

namespace strata {
namespace {

constexpr auto kStale = std::chrono::seconds(30);

}  // namespace

HealthFile::~HealthFile() {
  if (path_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void HealthFile::Write(std::string_view state) const {
  if (path_.empty()) return;
  const std::filesystem::path temporary = path_.string() + ".new";
  std::ofstream(temporary) << state << "\n";
  std::error_code error;
  std::filesystem::rename(temporary, path_, error);
  if (error) spdlog::warn("--health-file {}: {}", path_.string(), error.message());
}

absl::Status CheckHealthFile(const std::filesystem::path& file) {
  std::string state;
  std::ifstream(file) >> state;
  if (state != HealthFile::kConnected) {
    return absl::UnavailableError(
        absl::StrCat(file.string(), ": the worker is ", state.empty() ? "not running" : state));
  }
  std::error_code error;
  const auto age =
      std::filesystem::file_time_type::clock::now() - std::filesystem::last_write_time(file, error);
  if (error || age > kStale) {
    return absl::UnavailableError(
        absl::StrCat(file.string(), ": not written for 30 s; the worker hangs or was killed"));
  }
  return absl::OkStatus();
}

}  // namespace strata
