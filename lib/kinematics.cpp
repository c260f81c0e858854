#include "lib/kinematics.hpp"
