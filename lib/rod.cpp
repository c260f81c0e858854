#include "lib/rod.hpp"
