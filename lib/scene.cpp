#include "lib/scene.hpp"
