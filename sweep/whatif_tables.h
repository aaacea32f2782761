#pragma once

#include <string>
#include <vector>

#include "sweep/whatif_report.h"

namespace headpin::sweep {

/// A column of the three tables.
struct WhatIfColumn {
  const char* name;  ///< with the unit last
  const char* unit;
  const char* meaning;
};

/// Columns of every release, behind those that say which one it is.
const std::vector<WhatIfColumn>& release_columns();

/// CSV with a line of names.
std::string moments_csv(const WhatIf& whatif);
std::string releases_csv(const WhatIf& whatif);
std::string throws_csv(const WhatIf& whatif);

}  // namespace headpin::sweep
