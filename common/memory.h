#pragma once

namespace strata {

/// Tells the allocator to keep freed memory for the next buffers, up to 128 MB in each of its
/// arenas. For programs through which buffers of a megabyte pass all the time: given back to the
/// system, each would come again as pages to be cleared. Call it before there are threads.
void KeepFreedMemory();

}  // namespace strata
