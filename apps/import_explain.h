#pragma once

#include "apps/import_options.h"
#include "scene/scenario/scenario.h"

namespace headpin::apps {

/// Prints what `import` understands of a file, and what is missing; writes a file for --columns if an
/// output is named.
void explain_import(const ImportOptions& options, const scene::Scenario& scenario);

}  // namespace headpin::apps
