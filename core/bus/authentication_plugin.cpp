// The plugin of DDS Security that Cyclone DDS loads: Cyclone takes plugins from shared libraries
// only, and the code that wraps its own authentication is in the programs (authentication.cpp).
// They load this library first and say where that code is.
#include <cstdint>

extern "C" {

using AtriumInit = int (*)(const char* argument, void** context, void* domain);
using AtriumFinalize = int (*)(void* context);

static AtriumInit atrium_init = nullptr;
static AtriumFinalize atrium_finalize = nullptr;

void atrium_set_authentication(AtriumInit init, AtriumFinalize finalize) {
    atrium_init = init;
    atrium_finalize = finalize;
}

int init_authentication(const char* argument, void** context, void* domain) {
    return atrium_init == nullptr ? -1 : atrium_init(argument, context, domain);
}

int finalize_authentication(void* context) {
    return atrium_finalize == nullptr ? -1 : atrium_finalize(context);
}
}
