#include "scene/scenario.h"
