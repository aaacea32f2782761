# cmake -DSOURCE=DIR -DOUTPUT=FILE -DVERSION=X -P version.cmake
#
# Writes the source of version.h; left untouched when nothing has changed, so that nothing is built
# again.
execute_process(COMMAND git describe --always --abbrev=12 --exclude=* --dirty=+
                WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE commit ERROR_QUIET RESULT_VARIABLE failed
                OUTPUT_STRIP_TRAILING_WHITESPACE)
if(failed)
  set(commit "")
endif()
file(GLOB types ${SOURCE}/devices/lcm/types/*.lcm)
list(SORT types)
set(schema "")
foreach(type IN LISTS types)
  file(READ ${type} text)
  string(APPEND schema "${text}")
endforeach()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[#include "devices/base/version.h"

namespace headpin::devices {

const char* software_version() { return "@VERSION@"; }
const char* software_commit() { return "@commit@"; }
const char* schema_text() {
  return R"schema(@schema@)schema";
}

}  // namespace headpin::devices
]])
