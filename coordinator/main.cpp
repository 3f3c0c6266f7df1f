#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <optional>
#include <semaphore>

#include "common/build_info.h"
#include "common/memory.h"
#include "common/termination.h"
#include "coordinator/service/server.h"

namespace strata {
namespace {

struct Options {
  ServerOptions server;
  std::filesystem::path port_file;
  double silence_s = 10;
};

/// An exit status if the program is not to go on.
std::optional<int> ParseOptions(int argc, char** argv, Options* options) {
  CLI::App app("Plans jobs, leases their work to strata-worker processes and merges the results.",
               "strata-coordinator");
  app.footer(
      "Example:\n"
      "  strata-coordinator --listen 127.0.0.1:7447 --state /var/lib/strata");
  app.set_version_flag("--version", BuildRevision());
  app.add_option("--listen", options->server.listen, "HOST:PORT to serve; port 0 picks a free one")
      ->required();
  app.add_option("--state", options->server.farm.state_dir, "Directory for jobs, files and films")
      ->required();
  app.add_flag("--insecure", options->server.insecure,
               "Serve other machines without encryption; for trusted networks");
  app.add_option("--port-file", options->port_file, "Write the bound port to this file");
  app.add_option("--silence", options->silence_s,
                 "Seconds of silence after which a worker's leases go to others")
      ->check(CLI::Range(0.2, 3600.0))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const auto ms = static_cast<int64_t>(options->silence_s * 1000);
  options->server.farm.silence = std::chrono::milliseconds(ms);
  options->server.farm.heartbeat = std::chrono::milliseconds(ms * 3 / 5);
  return std::nullopt;
}

/// By rename, so that who waits for the file finds the whole number.
absl::Status WritePort(const std::filesystem::path& path, int port) {
  const std::filesystem::path temporary = path.string() + ".new";
  std::ofstream(temporary) << port << "\n";
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (!error) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat("--port-file ", path.string(), ": ", error.message()));
}

int Serve(const Options& options) {
  std::binary_semaphore stop(0);
  const TerminationSignals signals([&stop](int count) {
    if (count == 1) stop.release();
  });
  absl::StatusOr<std::unique_ptr<CoordinatorServer>> server =
      CoordinatorServer::Start(options.server);
  absl::Status status = server.status();
  if (status.ok() && !options.port_file.empty()) {
    status = WritePort(options.port_file, (*server)->port());
  }
  if (!status.ok()) {
    spdlog::error("{}", std::string(status.message()));
    return absl::IsUnavailable(status) ? 1 : 2;
  }
  spdlog::info("strata-coordinator {} serves port {}, state in {}", BuildRevision(),
               (*server)->port(), options.server.farm.state_dir.string());
  stop.acquire();
  spdlog::info("stopping");
  (*server)->Stop();
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  strata::KeepFreedMemory();
  strata::BlockTerminationSignals();
  strata::Options options;
  if (const std::optional<int> status = strata::ParseOptions(argc, argv, &options)) return *status;
  return strata::Serve(options);
}
