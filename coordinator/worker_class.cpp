#include "coordinator/worker_class.h"

#include <fmt/format.h>

#include <string_view>

namespace strata {
namespace {

std::string Differs(std::string_view what, std::string_view worker, std::string_view job) {
  return fmt::format("{} {} where the job has {}", what, worker, job);
}

std::string VersionOf(const WorkerClass& worker_class, const std::string& library) {
  const auto version = worker_class.libraries.find(library);
  return version == worker_class.libraries.end() ? "none" : version->second;
}

}  // namespace

WorkerClass ClassOf(const Hello& hello) {
  return {hello.build, hello.kernel_revision, hello.libraries, hello.isa, hello.traced};
}

std::string Difference(const WorkerClass& worker, const WorkerClass& job) {
  if (worker.build != job.build) return Differs("build", worker.build, job.build);
  if (worker.kernel_revision != job.kernel_revision) {
    return Differs("kernel revision", std::to_string(worker.kernel_revision),
                   std::to_string(job.kernel_revision));
  }
  for (const auto* libraries : {&job.libraries, &worker.libraries}) {
    for (const auto& [library, version] : *libraries) {
      const std::string theirs = VersionOf(worker, library), ours = VersionOf(job, library);
      if (theirs != ours) return Differs(library, theirs, ours);
    }
  }
  if (worker.isa != job.isa) return Differs("instruction set", worker.isa, job.isa);
  if (worker.traced != job.traced) {
    return Differs("traced digest", worker.traced.Hex().substr(0, 12),
                   job.traced.Hex().substr(0, 12));
  }
  return "";
}

}  // namespace strata
