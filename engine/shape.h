#pragma once

#include "engine/math.h"
