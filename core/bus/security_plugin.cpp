// The plugins of DDS Security that Cyclone DDS loads: Cyclone takes plugins from shared libraries
// only, and the code that wraps its own is in the programs (authentication.cpp). They load this
// library first and say where that code is.
#include <array>

extern "C" {

using AtriumInit = int (*)(const char* argument, void** context, void* domain);
using AtriumFinalize = int (*)(void* context);

// of authentication and of encryption
static std::array<AtriumInit, 2> atrium_init{};
static std::array<AtriumFinalize, 2> atrium_finalize{};

void atrium_set_security(const AtriumInit* init, const AtriumFinalize* finalize) {
    atrium_init = {init[0], init[1]};
    atrium_finalize = {finalize[0], finalize[1]};
}

int init_authentication(const char* argument, void** context, void* domain) {
    return atrium_init[0] == nullptr ? -1 : atrium_init[0](argument, context, domain);
}

int finalize_authentication(void* context) {
    return atrium_finalize[0] == nullptr ? -1 : atrium_finalize[0](context);
}

int init_crypto(const char* argument, void** context, void* domain) {
    return atrium_init[1] == nullptr ? -1 : atrium_init[1](argument, context, domain);
}

int finalize_crypto(void* context) {
    return atrium_finalize[1] == nullptr ? -1 : atrium_finalize[1](context);
}
}
