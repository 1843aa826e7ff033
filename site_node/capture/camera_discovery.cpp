#include "site_node/capture/camera_discovery.hpp"

#include "core/base/descriptor.hpp"
#include "site_node/capture/aravis_handle.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace atrium::capture {
namespace {

constexpr std::chrono::milliseconds kAnswerTime{200};  // usually below 10 ms in a local network
constexpr std::chrono::seconds kDiscoveryIsFresh{2};

// GigE Vision Control Protocol: discovery is the one command that needs no control of the camera.
constexpr std::uint16_t kGvcpPort = 3956;
constexpr std::array<std::uint8_t, 8> kDiscoveryCommand{0x42, 0x01, 0x00, 0x02, 0, 0, 0x41, 0x54};
constexpr std::size_t kHeaderBytes = 8;
constexpr std::size_t kAnswerBytes = kHeaderBytes + 0xf8;
struct TextField {
    std::size_t offset;
    std::size_t size;
};
constexpr TextField kVendor{0x48, 32}, kModel{0x68, 32}, kSerial{0xd8, 16};

std::string text_at(const std::array<std::uint8_t, 1024>& answer, TextField field) {
    const auto* begin = reinterpret_cast<const char*>(answer.data()) + kHeaderBytes + field.offset;
    return {begin, strnlen(begin, field.size)};
}

bool is_answer(const std::array<std::uint8_t, 1024>& answer, ssize_t num_bytes) {
    return num_bytes >= static_cast<ssize_t>(kAnswerBytes) && answer[0] == 0 && answer[1] == 0 &&
           answer[2] == 0 && answer[3] == 3 && answer[6] == kDiscoveryCommand[6] &&
           answer[7] == kDiscoveryCommand[7];
}

std::string text(const char* maybe) { return maybe == nullptr ? "" : maybe; }

}  // namespace

std::vector<FoundCamera> discover_cameras() {
    static std::mutex mutex;  // Aravis has one list per process, read by index
    const std::lock_guard lock(mutex);
    arv_update_device_list();
    std::vector<FoundCamera> cameras;
    for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
        FoundCamera camera{text(arv_get_device_vendor(i)),
                           text(arv_get_device_model(i)),
                           text(arv_get_device_serial_nbr(i)),
                           text(arv_get_device_address(i)),
                           text(arv_get_device_protocol(i))};
        if (camera.protocol != "GigEVision") camera.address = text(arv_get_device_id(i));
        cameras.push_back(std::move(camera));
    }
    std::sort(cameras.begin(), cameras.end(), [](const FoundCamera& a, const FoundCamera& b) {
        return a.address < b.address;
    });
    return cameras;
}

std::optional<FoundCamera> ask_gige_camera(const std::string& address,
                                           std::chrono::milliseconds timeout) {
    sockaddr_in target{};
    target.sin_family = AF_INET;
    target.sin_port = htons(kGvcpPort);
    const Descriptor handle(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (handle.get() < 0 || inet_pton(AF_INET, address.c_str(), &target.sin_addr) != 1)
        return std::nullopt;
    // connected: a closed port then returns an error at once
    if (connect(handle.get(), reinterpret_cast<const sockaddr*>(&target), sizeof(target)) != 0 ||
        send(handle.get(), kDiscoveryCommand.data(), kDiscoveryCommand.size(), 0) < 0) {
        return std::nullopt;
    }
    const auto end = std::chrono::steady_clock::now() + timeout;
    std::array<std::uint8_t, 1024> answer{};
    for (auto left = timeout; left.count() > 0;
         left = std::chrono::duration_cast<std::chrono::milliseconds>(
             end - std::chrono::steady_clock::now())) {
        pollfd waiting{handle.get(), POLLIN, 0};
        if (poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
        const ssize_t num_bytes = recv(handle.get(), answer.data(), answer.size(), MSG_DONTWAIT);
        if (num_bytes < 0) return std::nullopt;
        if (!is_answer(answer, num_bytes)) continue;
        return FoundCamera{text_at(answer, kVendor),
                           text_at(answer, kModel),
                           text_at(answer, kSerial),
                           address,
                           "GigEVision"};
    }
    return std::nullopt;
}

std::string camera_table(const std::vector<FoundCamera>& cameras) {
    std::vector<std::array<std::string, 5>> rows{
        {"vendor", "model", "serial", "address", "protocol"}};
    for (const FoundCamera& c : cameras)
        rows.push_back({c.vendor, c.model, c.serial, c.address, c.protocol});
    std::array<std::size_t, 5> widths{};
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string table;
    for (const auto& row : rows) {
        for (std::size_t i = 0; i + 1 < row.size(); ++i)
            table += fmt::format("{:<{}}  ", row[i], widths[i]);
        table += row.back() + "\n";
    }
    return table;
}

std::optional<FoundCamera> CameraFinder::known(const std::string& serial) {
    for (const FoundCamera& camera : found_) {
        if (camera.serial == serial) return camera;
    }
    return std::nullopt;
}

Expected<FoundCamera> CameraFinder::find(const std::string& serial, const std::string& address) {
    const auto not_found = [](std::string text) {
        return make_error(ErrorKind::kNotFound, std::move(text));
    };
    if (!address.empty()) {
        const auto camera = ask_gige_camera(address, kAnswerTime);
        if (!camera) return not_found(fmt::format("no camera answers at {}", address));
        if (!serial.empty() && camera->serial != serial) {
            return not_found(fmt::format("the camera at {} has serial number '{}', not '{}'",
                                         address,
                                         camera->serial,
                                         serial));
        }
        return *camera;
    }
    const std::lock_guard lock(mutex_);
    bool is_silent = false;
    if (const auto camera = known(serial); camera && camera->protocol == "GigEVision") {
        const auto answer = ask_gige_camera(camera->address, kAnswerTime);
        if (answer && answer->serial == serial) return *answer;
        is_silent = true;
    }
    const auto now = std::chrono::steady_clock::now();
    if (!last_discovery_ || now - *last_discovery_ > kDiscoveryIsFresh) {
        found_ = discover_cameras();
        last_discovery_ = std::chrono::steady_clock::now();
        is_silent = false;
    }
    if (const auto camera = known(serial); camera && !is_silent) return *camera;
    return not_found(
        fmt::format("no camera with serial number '{}' answers (site_node --list-cameras shows all "
                    "that do, atrium doctor why)",
                    serial));
}

}  // namespace atrium::capture
