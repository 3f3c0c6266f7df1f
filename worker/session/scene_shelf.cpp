#include "worker/session/scene_shelf.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace strata {

uint64_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  uint64_t total_pages = 0, resident_pages = 0;
  statm >> total_pages >> resident_pages;
  return resident_pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

std::shared_ptr<const LoadedScene> SceneShelf::Find(const Digest& bundle) {
  const auto found = std::find_if(scenes_.begin(), scenes_.end(),
                                  [&](const auto& scene) { return scene.first == bundle; });
  if (found == scenes_.end()) return nullptr;
  scenes_.splice(scenes_.begin(), scenes_, found);
  return scenes_.front().second;
}

void SceneShelf::Put(const Digest& bundle, std::shared_ptr<const LoadedScene> scene) {
  scenes_.emplace_front(bundle, std::move(scene));
  if (scenes_.size() > kScenes) scenes_.pop_back();
}

bool SceneShelf::MakeRoom() {
  if (memory_limit_ == 0) return true;
  while (ResidentBytes() > memory_limit_) {
    if (scenes_.empty()) return false;
    scenes_.pop_back();
    malloc_trim(0);  // Freed pages count until they are given back.
  }
  return true;
}

}  // namespace strata
