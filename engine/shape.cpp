#include "engine/shape.h"
