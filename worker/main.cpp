#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <optional>
#include <thread>

#include "common/build_info.h"
#include "common/termination.h"
#include "common/wire/channel.h"
#include "worker/service/worker_client.h"

namespace strata {
namespace {

struct Options {
  std::string server;
  bool insecure = false;
  std::filesystem::path check;  ///< Not empty: only look at this health file.
  WorkerOptions worker;
};

/// An exit status if the program is not to go on.
std::optional<int> ParseOptions(int argc, char** argv, Options* options) {
  CLI::App app("Renders for a strata-coordinator until told to stop.", "strata-worker");
  app.footer(
      "Example:\n"
      "  strata-worker --server 127.0.0.1:7447 --cache ~/.cache/strata\n\n"
      "SIGTERM and SIGINT let it finish what it holds; a second one ends it at once.");
  app.set_version_flag("--version", BuildRevision());
  WorkerOptions& worker = options->worker;
  worker.threads = std::max(1u, std::thread::hardware_concurrency());
  app.add_option("--server", options->server, "HOST:PORT of the coordinator")
      ->envname("STRATA_SERVER");
  app.add_option("--cache", worker.cache_dir, "Directory that keeps the files of scenes");
  app.add_option("--cache-limit", worker.cache_bytes, "Most bytes kept there")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app.add_option("--threads", worker.threads, "Threads that render; default: all cores")
      ->check(CLI::Range(1, 4096));
  app.add_option("--name", worker.name, "What people call it; default: the host's name");
  app.add_option("--tags", worker.tags, "Words that say what it is, shown by strata workers")
      ->delimiter(',');
  app.add_option("--memory-limit", worker.memory_limit, "Most bytes of memory for scenes")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--health-file", worker.health_file, "Keep the state of the link in this file");
  app.add_flag("--insecure", options->insecure,
               "Dial other machines without encryption; for trusted networks");
  app.add_option("--check", options->check,
                 "Only exit 0 if the worker of this health file is connected, else 1");
  try {
    app.parse(argc, argv);
    if (options->check.empty()) {
      if (options->server.empty()) throw CLI::RequiredError("--server");
      if (worker.cache_dir.empty()) throw CLI::RequiredError("--cache");
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return std::nullopt;
}

absl::Status Work(const Options& options) {
  STRATA_ASSIGN_OR_RETURN(std::shared_ptr<grpc::Channel> channel,
                          wire::Dial(options.server, options.insecure));
  STRATA_ASSIGN_OR_RETURN(const std::unique_ptr<WorkerClient> client,
                          WorkerClient::Create(std::move(channel), options.worker));
  const TerminationSignals signals([&client](int count) {
    if (count > 1) std::_Exit(1);  // Results are idempotent: nothing can be half done.
    spdlog::info("finishing what is held; a second signal ends at once");
    client->Drain();
  });
  spdlog::info("strata-worker {} with {} threads, coordinator {}", BuildRevision(),
               options.worker.threads, options.server);
  return client->Run();
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  strata::BlockTerminationSignals();
  strata::Options options;
  if (const std::optional<int> status = strata::ParseOptions(argc, argv, &options)) return *status;
  const bool checking = !options.check.empty();
  const absl::Status status =
      checking ? strata::CheckHealthFile(options.check) : strata::Work(options);
  if (status.ok()) return 0;
  spdlog::error("{}", std::string(status.message()));
  return absl::IsUnavailable(status) ? 1 : 2;
}
