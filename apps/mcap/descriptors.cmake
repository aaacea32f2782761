# cmake -DPROTOC=PROGRAM -DPROTO=FILE -DOUTPUT=FILE.cpp -P descriptors.cmake
#
# Writes the source of foxglove::descriptors(): what protoc makes of the messages, as bytes.
cmake_path(GET PROTO PARENT_PATH folder)
execute_process(COMMAND ${PROTOC} --proto_path=${folder} --include_imports --descriptor_set_out=${OUTPUT}.bin ${PROTO}
                COMMAND_ERROR_IS_FATAL ANY)
file(READ ${OUTPUT}.bin bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(................................................................................)" "\\1\n" bytes "${bytes}")
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[#include "apps/mcap/foxglove.h"

namespace headpin::apps::foxglove {

std::string_view descriptors() {
  static constexpr unsigned char kBytes[] = {
@bytes@};
  return {reinterpret_cast<const char*>(kBytes), sizeof kBytes};
}

}  // namespace headpin::apps::foxglove
]])
