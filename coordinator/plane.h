#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <vector>

namespace strata {

/// Puts what is large into huge pages, where the system has them for those who ask. A plane of a 4K
/// picture is 66 MB, and sixteen thousand page faults take longer than most of what is done with it
/// (bench_planning).
template <typename T>
struct HugePages {
  using value_type = T;
  HugePages() = default;
  template <typename U>
  explicit HugePages(const HugePages<U>&) {}

  T* allocate(size_t count) {
    const size_t bytes = count * sizeof(T);
    void* memory = ::operator new(bytes, AlignmentOf(bytes));
    if (IsLarge(bytes)) madvise(memory, bytes, MADV_HUGEPAGE);  // If not, it is slower.
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, size_t count) {
    ::operator delete(memory, AlignmentOf(count * sizeof(T)));
  }
  bool operator==(const HugePages&) const = default;

 private:
  static constexpr size_t kPage = size_t{2} << 20;
  static bool IsLarge(size_t bytes) { return bytes >= 2 * kPage; }
  static std::align_val_t AlignmentOf(size_t bytes) {
    return std::align_val_t{IsLarge(bytes) ? kPage : alignof(T)};
  }
};

/// A row-major plane of width x height pixels.
struct PlaneSize {
  size_t width = 0, height = 0;
  size_t Pixels() const { return width * height; }
};

/// A number for each of its pixels.
using Plane = std::vector<double, HugePages<double>>;

}  // namespace strata
