#include "site_node/capture/aravis_access.hpp"

#include "site_node/capture/network_interface.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

namespace atrium::capture {
namespace {

constexpr guint64 kControlRegister = 0x0a00;  // GigE Vision control channel privilege
constexpr guint32 kControlBits = 3;

// Never destroyed, and its thread never joined: the program must not wait for a lost camera.
struct DeferredRelease {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::shared_ptr<void>> dead;

    static DeferredRelease& instance() {
        static auto* const deferred = new DeferredRelease;
        return *deferred;
    }

    DeferredRelease() {
        std::thread([this] {
            for (;;) {
                std::shared_ptr<void> next;
                std::unique_lock lock(mutex);
                changed.wait(lock, [this] { return !dead.empty(); });
                next = std::move(dead.front());
                dead.pop_front();
                lock.unlock();
            }
        }).detach();
    }
};

}  // namespace

Expected<GPtr<ArvCamera>> open_camera(const FoundCamera& found) {
    static std::mutex mutex;  // Aravis misreads the descriptions of two cameras at once
    const std::lock_guard lock(mutex);
    const auto failed = [&](const std::string& reason) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot open the camera at {}: {}", found.address, reason));
    };
    GErrorSlot error;
    if (found.protocol != "GigEVision") {
        GPtr<ArvCamera> camera(arv_camera_new(found.address.c_str(), error.out()));
        if (camera == nullptr) return failed(error.message());
        return camera;
    }
    // not by name: Aravis would search all networks again, one camera at a time
    const std::string own = own_address_towards(found.address);
    if (own.empty()) return failed("no interface has a route to it");
    const GPtr<GInetAddress> own_address(g_inet_address_new_from_string(own.c_str()));
    const GPtr<GInetAddress> address(g_inet_address_new_from_string(found.address.c_str()));
    const GPtr<ArvDevice> device(arv_gv_device_new(own_address.get(), address.get(), error.out()));
    if (device == nullptr || error.failed()) return failed(error.message());
    if (!arv_gv_device_is_controller(ARV_GV_DEVICE(device.get())))
        return failed("another program controls it");
    GPtr<ArvCamera> camera(arv_camera_new_with_device(device.get(), error.out()));
    if (camera == nullptr || error.failed()) return failed(error.message());
    return camera;
}

bool is_under_control(ArvCamera& camera) {
    GErrorSlot error;
    if (!arv_camera_is_gv_device(&camera)) {
        arv_camera_get_integer(&camera, "Width", error.out());
        return !error.failed();
    }
    guint32 value = 0;
    arv_device_read_register(arv_camera_get_device(&camera), kControlRegister, &value, error.out());
    return !error.failed() && (value & kControlBits) != 0;
}

bool is_ptp_locked(ArvCamera& camera) {
    GErrorSlot error;
    for (const char* feature : {"PtpStatus", "GevIEEE1588Status"}) {
        if (!arv_camera_is_feature_available(&camera, feature, error.out())) continue;
        const char* const status = arv_camera_get_string(&camera, feature, error.out());
        if (status == nullptr) continue;
        return std::string(status) == "Slave" || std::string(status) == "Master";
    }
    return false;
}

void release_in_background(std::shared_ptr<void> dead) {
    DeferredRelease& deferred = DeferredRelease::instance();
    {
        const std::lock_guard lock(deferred.mutex);
        deferred.dead.push_back(std::move(dead));
    }
    deferred.changed.notify_one();
}

}  // namespace atrium::capture
