#include "hb/stability.hpp"
