#include "models/fit/fit.h"
