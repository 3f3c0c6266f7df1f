#pragma once

/// Before a function whose loops over lanes cost most: it is compiled for the instructions of the
/// build (AVX2) and once more for AVX-512, whose masks and 32 registers save time even in vectors
/// of eight (docs/decisions.md says how much); the loader takes what the processor has. What it
/// calls inline goes with it. Both give the same bits: every operation is rounded by itself, and
/// nothing is contracted. Clang 14 compiles the first alone.
#if defined(__GNUC__) && !defined(__clang__)
#define STRATA_CPU_CLONES [[gnu::target_clones("default", "arch=x86-64-v4")]]
#else
#define STRATA_CPU_CLONES
#endif
