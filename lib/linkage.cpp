#include "lib/linkage.hpp"
