#pragma once

#include <cstddef>  // says which C library this is

// Full inlining saves a third of the time of a search, and a tenth of a step in the solution of
// islands. In a sanitizer build it costs minutes, because every copy has its own checks; there the
// compiler decides.
#ifdef HEADPIN_SANITIZED
#define HEADPIN_INLINE
#define HEADPIN_FLATTEN
#else
#define HEADPIN_INLINE __attribute__((always_inline))
#define HEADPIN_FLATTEN __attribute__((flatten))
#endif

/// For functions that run rarely or have many callers. With a copy in every caller, the search takes
/// half as long again to compile.
#define HEADPIN_OUT_OF_LINE __attribute__((noinline))

/// For functions with many operations on few numbers: built a second time for processors with AVX,
/// whose instructions keep their operands, so that fewer are needed. The operations are the same, and
/// so are the bits. The program chooses one of the two when it starts.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__AVX__) && !defined(HEADPIN_SANITIZED) && !defined(__SANITIZE_ADDRESS__) &&    \
    !defined(__SANITIZE_THREAD__)
#define HEADPIN_ALSO_AVX __attribute__((target_clones("avx", "default")))
#else
#define HEADPIN_ALSO_AVX
#endif
