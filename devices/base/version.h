#pragma once

/// The version of the software, for logs.
namespace headpin::devices {

const char* software_version();  ///< as in the project's CMakeLists.txt
const char* software_commit();   ///< of the tree it was built from, "+" if changed; "" outside git
const char* schema_text();       ///< all .lcm files, in the order of their names

}  // namespace headpin::devices
