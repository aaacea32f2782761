#pragma once

#include <array>
#include <string_view>

/// What the program reads of its environment, for the manual.
namespace headpin::apps {

struct Variable {
  std::string_view name, says;
};

inline constexpr std::array kEnvironment = {
    Variable{"HEADPIN_GL", "the OpenGL context where --gl is not given, with the same words"},
    Variable{"LCM_DEFAULT_URL", "the URL of LCM where none is given; else udpm://"},
    Variable{"TMPDIR", "the folder of temporary files; else /tmp"},
    Variable{"PATH", "where ffmpeg, Rscript and other programs are looked for"},
    Variable{"CUDA_VISIBLE_DEVICES", "the numbers of the graphics cards that egl:auto may take"},
    Variable{"LP_NUM_THREADS",
             "threads in which Mesa draws; 0, in the program's own, when not set"},
    Variable{"LP_NATIVE_VECTOR_WIDTH", "128 or 256: the width of the vectors that Mesa draws with"},
    Variable{"GALLIUM_DRIVER", "llvmpipe or softpipe: what Mesa draws with"},
    Variable{"GALLIUM_OVERRIDE_CPU_CAPS", "the highest feature of the processor that Mesa uses"},
};

}  // namespace headpin::apps
