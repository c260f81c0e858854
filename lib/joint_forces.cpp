#include "lib/joint_forces.hpp"
