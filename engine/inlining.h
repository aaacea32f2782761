#pragma once

// Inlining all of a search is worth a third of its time, all of an island's solution a tenth of a
// step; it costs a sanitizer build minutes, as its checks are multiplied with every copy. There it
// is left to the compiler.
#ifdef HEADPIN_SANITIZED
#define HEADPIN_INLINE
#define HEADPIN_FLATTEN
#else
#define HEADPIN_INLINE __attribute__((always_inline))
#define HEADPIN_FLATTEN __attribute__((flatten))
#endif

/// For what is rarely come to, or called from many places: a copy in every caller would cost the
/// compiler half of its time.
#define HEADPIN_OUT_OF_LINE __attribute__((noinline))
