// How many workers one coordinator feeds: a simulation of a farm, event by event, with the
// scheduler's own decisions and costs that bench_coordinator measures. docs/scale.md has what it
// says.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>
#include <queue>
#include <random>
#include <vector>

#include "common/pixel_layout.h"
#include "coordinator/round_plan.h"
#include "coordinator/schedule.h"
#include "coordinator/unit_queue.h"

namespace strata {
namespace {

struct Options {
  std::vector<int> workers = {1, 10, 30, 100, 300, 1000, 3000};
  double rate = 2e6;  ///< Samples/s of a worker.
  int width = 1920, height = 1080, tile = 32;
  uint32_t spp = 1024;
  int cores = 2;             ///< Of the coordinator.
  double merge_mb_s = 550;   ///< Of partials, by each core.
  double unit_us = 100;      ///< CPU for each partial besides.
  double worker_us = 70;     ///< CPU per second for each worker that is connected.
  double link_gbit_s = 10;   ///< Into the coordinator.
  double rtt_ms = 0.2;       ///< Between it and a worker.
  double spread = 0.5;       ///< Of the logarithm of what a tile's samples cost.
  double worker_spread = 0;  ///< Of the logarithm of workers' rates.
};

struct Outcome {
  double seconds = 0;          ///< Of the frame.
  double efficiency = 0;       ///< Time that rates alone would need, over that.
  double cpu = 0, link = 0;    ///< Shares of the coordinator's that were busy.
  double waited_ms = 0;        ///< Of a worker between two units, mean.
  double most_waiting_mb = 0;  ///< Partials kept for those before them.
};

class Simulation {
 public:
  Simulation(const Options& options, int workers)
      : options_(options), plan_(MakePlan(options)), workers_(static_cast<size_t>(workers)) {
    std::mt19937 random(1);
    const auto normal = [&] {  // Irwin and Hall's: the same numbers anywhere.
      double sum = -6;
      for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) * 0x1p-32;
      return sum;
    };
    for (Worker& worker : workers_)
      worker.rate = options.rate * std::exp(options.worker_spread * normal());
    double sum = 0;
    for (uint32_t t = 0; t < plan_->grid.Count(); ++t) {
      cost_.push_back(std::exp(options.spread * normal()));
      sum += cost_.back();
    }
    for (double& cost : cost_) cost *= static_cast<double>(cost_.size()) / sum;
    fronts_.resize(cost_.size());
    arrived_.resize(cost_.size());
    core_free_.resize(static_cast<size_t>(options.cores));
    // What is spent on links that are idle is taken off every core's speed.
    const double left = 1 - 1e-6 * options.worker_us * workers / options.cores;
    core_speed_ = std::max(left, 1e-3);
  }

  Outcome Run() {
    UnitQueue queue(plan_, WindowFor(plan_->grid.Count(), static_cast<int>(workers_.size())));
    queue_ = &queue;
    const uint64_t units = plan_->Units();
    for (size_t w = 0; w < workers_.size(); ++w) hungry_.push_back(w);
    Dispatch(0);
    uint64_t merged = 0;
    double now = 0;
    while (merged < units && !events_.empty()) {
      const Event event = events_.top();
      events_.pop();
      now = event.time;
      if (event.kind == Event::kLease) {
        StartNext(event.worker, now);
      } else if (event.kind == Event::kRendered) {
        Send(event, now);
        Worker& worker = workers_[event.worker];
        worker.rendering = false;
        worker.idle_since = now;
        StartNext(event.worker, now);
      } else {
        ++merged;
        Receive(event);
        Dispatch(now);
      }
    }
    Outcome outcome;
    double work = 0, rate = 0;
    for (uint32_t t = 0; t < cost_.size(); ++t)
      work += cost_[t] * static_cast<double>(plan_->grid.Rect(t).Pixels()) * options_.spp;
    for (const Worker& worker : workers_) rate += worker.rate;
    outcome.seconds = now;
    outcome.efficiency = work / rate / now;
    outcome.cpu = cpu_ / (now * options_.cores) + 1 - core_speed_;
    outcome.link = link_ / now;
    outcome.waited_ms = waits_ > 0 ? 1e3 * waited_ / static_cast<double>(waits_) : 0;
    outcome.most_waiting_mb = 1e-6 * most_waiting_;
    return outcome;
  }

 private:
  struct Worker {
    double rate = 0;
    std::deque<std::deque<UnitId>> leases;  ///< Those that have come.
    int granted = 0;                        ///< Leases of which some unit is not received yet.
    std::map<UnitId, uint64_t> lease_of;
    std::map<uint64_t, size_t> left;  ///< Units of each lease not received.
    bool rendering = false;
    double idle_since = -1;
    double known_rate = 0;  ///< Samples/s, once something came.
    double rendered_since = 0;
  };
  struct Event {
    enum Kind { kLease, kRendered, kMerged };
    double time;
    Kind kind;
    size_t worker;
    UnitId unit;
    bool operator<(const Event& other) const { return time > other.time; }
  };

  static std::shared_ptr<const RoundPlan> MakePlan(const Options& options) {
    RoundPlan plan;
    plan.grid = {{0, 0, options.width, options.height}, options.tile};
    const SampleRange range = {0, options.spp / kReplicates};
    plan.classes = {{range, CutPieces(range)}};
    return std::make_shared<const RoundPlan>(std::move(plan));
  }

  double Samples(const UnitId& unit) const {
    return static_cast<double>(SamplesIn(*plan_->Unit(unit)));
  }
  double Bytes(const UnitId& unit) const {
    constexpr double kCounts = sizeof(uint32_t) + sizeof(uint64_t) + sizeof(uint32_t);
    return static_cast<double>(plan_->grid.Rect(unit.tile).Pixels()) *
           (8.0 * PixelLayout{}.Doubles() + kCounts);
  }

  void StartNext(size_t w, double now) {
    Worker& worker = workers_[w];
    while (!worker.leases.empty() && worker.leases.front().empty()) worker.leases.pop_front();
    if (worker.rendering || worker.leases.empty()) return;
    const UnitId unit = worker.leases.front().front();
    worker.leases.front().pop_front();
    if (worker.idle_since >= 0) {
      waited_ += now - worker.idle_since;
      ++waits_;
    }
    worker.rendering = true;
    events_.push({now + Samples(unit) * cost_[unit.tile] / worker.rate, Event::kRendered, w, unit});
  }

  /// Over the link, then to the first core that is free.
  void Send(const Event& rendered, double now) {
    const double on_link = Bytes(rendered.unit) / (options_.link_gbit_s * 1e9 / 8);
    link_free_ = std::max(link_free_, now) + on_link;
    link_ += on_link;
    double& core = *std::min_element(core_free_.begin(), core_free_.end());
    const double cpu = Bytes(rendered.unit) / (options_.merge_mb_s * 1e6) + 1e-6 * options_.unit_us;
    core = std::max(core, link_free_ + 0.5e-3 * options_.rtt_ms) + cpu / core_speed_;
    cpu_ += cpu;
    events_.push({core, Event::kMerged, rendered.worker, rendered.unit});
  }

  void Receive(const Event& event) {
    const UnitId& unit = event.unit;
    std::map<uint32_t, double>& waiting = arrived_[unit.tile];
    waiting[unit.piece] = Bytes(unit);
    waiting_ += Bytes(unit);
    uint32_t& front = fronts_[unit.tile];
    for (auto it = waiting.begin(); it != waiting.end() && it->first == front; ++front) {
      waiting_ -= it->second;
      it = waiting.erase(it);
    }
    most_waiting_ = std::max(most_waiting_, waiting_);
    queue_->Received(unit, front);

    Worker& worker = workers_[event.worker];
    const double seconds = std::max(event.time - worker.rendered_since, 1e-9);
    worker.known_rate = Samples(unit) / seconds;
    worker.rendered_since = event.time;
    const auto lease = worker.lease_of.find(unit);
    if (--worker.left[lease->second] == 0) {
      worker.left.erase(lease->second);
      if (worker.granted-- == kLeasesPerWorker) hungry_.push_back(event.worker);
    }
    worker.lease_of.erase(lease);
  }

  void Dispatch(double now) {
    const auto any = [](const UnitId&) { return true; };
    std::vector<size_t> still;
    for (const size_t w : hungry_) {
      Worker& worker = workers_[w];
      while (worker.granted < kLeasesPerWorker) {
        std::optional<UnitId> unit = queue_->Next(any);
        if (!unit) break;
        LeaseSizing sizing;
        sizing.samples_per_second = worker.known_rate;
        sizing.samples_per_unit =
            static_cast<double>(plan_->Samples()) / static_cast<double>(units_);
        sizing.pending_units = queue_->Pending();
        sizing.workers = static_cast<int>(workers_.size());
        const uint64_t wanted = UnitsForLease(sizing);
        std::deque<UnitId> units;
        for (; unit && units.size() < wanted; unit = queue_->Next(any)) {
          queue_->Take(*unit);
          units.push_back(*unit);
          worker.lease_of[*unit] = last_lease_;
        }
        worker.left[last_lease_++] = units.size();
        ++worker.granted;
        worker.leases.push_back(std::move(units));
        events_.push({now + 0.5e-3 * options_.rtt_ms, Event::kLease, w, {}});
      }
      if (worker.granted < kLeasesPerWorker) still.push_back(w);
    }
    hungry_ = std::move(still);
  }

  const Options options_;
  std::shared_ptr<const RoundPlan> plan_;
  const uint64_t units_ = plan_->Units();
  UnitQueue* queue_ = nullptr;
  std::vector<Worker> workers_;
  std::vector<size_t> hungry_;  ///< Workers with too few leases.
  std::vector<double> cost_;    ///< Of a tile's samples; 1 on average.
  std::vector<uint32_t> fronts_;
  std::vector<std::map<uint32_t, double>> arrived_;  ///< Bytes, by piece.
  std::vector<double> core_free_;
  std::priority_queue<Event> events_;
  double core_speed_ = 1, link_free_ = 0;
  double cpu_ = 0, link_ = 0, waited_ = 0, waiting_ = 0, most_waiting_ = 0;
  uint64_t waits_ = 0, last_lease_ = 0;
};

int Main(int argc, char** argv) {
  CLI::App app("Simulates a farm: how many workers one coordinator feeds");
  Options options;
  app.add_option("--workers", options.workers, "how many; a list")->delimiter(',');
  app.add_option("--rate", options.rate, "samples/s of a worker")->check(CLI::PositiveNumber);
  app.add_option("--width", options.width)->check(CLI::Range(1, 65536));
  app.add_option("--height", options.height)->check(CLI::Range(1, 65536));
  app.add_option("--tile", options.tile)->check(CLI::Range(1, 65536));
  app.add_option("--spp", options.spp)->check(CLI::Range(8, 1 << 20));
  app.add_option("--cores", options.cores, "of the coordinator")->check(CLI::Range(1, 1024));
  app.add_option("--merge-mb-s", options.merge_mb_s, "of partials, by each core");
  app.add_option("--unit-us", options.unit_us, "CPU for each partial besides");
  app.add_option("--worker-us", options.worker_us, "CPU per second for each worker connected");
  app.add_option("--link-gbit-s", options.link_gbit_s, "into the coordinator");
  app.add_option("--rtt-ms", options.rtt_ms, "between coordinator and worker");
  app.add_option("--spread", options.spread, "of the logarithm of tiles' costs");
  app.add_option("--worker-spread", options.worker_spread, "of the logarithm of workers' rates");
  CLI11_PARSE(app, argc, argv);
  std::printf("%8s %10s %11s %7s %7s %10s %12s\n", "workers", "seconds", "efficiency", "cpu",
              "link", "wait, ms", "waiting, MB");
  for (const int workers : options.workers) {
    const Outcome o = Simulation(options, workers).Run();
    std::printf("%8d %10.2f %11.3f %7.3f %7.3f %10.3f %12.1f\n", workers, o.seconds, o.efficiency,
                o.cpu, o.link, o.waited_ms, o.most_waiting_mb);
  }
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
