// Of every program that is built with sanitizers: what their runtime, which is in the program, asks for.

// Mesa and its compiler do not free some memory before the end of the process. Nor does fontconfig,
// which finds the fonts of plots (apps/rsvg.h).
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libLLVM\nleak:libEGL\nleak:swrast_dri.so\nleak:libfontconfig\n";
}

// Of thread-local memory that a library brings when it is loaded, clang 14's runtime reads a header
// that glibc has not written since 2.25, whenever that memory happens to begin 16 bytes into a page:
// the search for leaks then crashes at an address that is none. So that memory is not recorded.
extern "C" const char* __asan_default_options() {
  return "intercept_tls_get_addr=0";
}
