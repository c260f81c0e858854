// The library toml++ inside the program `hb`, compiled from its headers: nothing of it has to be bound at every start.
#define TOML_IMPLEMENTATION

#include <toml++/toml.h>
