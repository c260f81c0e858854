#include "hb/steady_state.hpp"
