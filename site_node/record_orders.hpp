#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "site_node/record/raw_recorder.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

namespace atrium::site_node {

/// Takes orders over the bus to record the cameras (RoomRecordOrder), and says once a second how
/// the recording stands (RoomRecording). Each recording is a new folder inside of one folder: an
/// order, which may come from anybody in the world, names nothing outside of it.
class RecordOrders {
public:
    static Expected<std::unique_ptr<RecordOrders>> create(const bus::Participant& participant,
                                                          std::string site,
                                                          std::filesystem::path folder,
                                                          record::RawRecorder& recorder);
    /// The body of a thread.
    void run(std::stop_token stop);

private:
    using Clock = std::chrono::steady_clock;
    RecordOrders(std::string site,
                 std::filesystem::path folder,
                 record::RawRecorder& recorder,
                 bus::Waiter waiter,
                 bus::Reader<bus::RoomRecordOrder> orders,
                 bus::Writer<bus::RoomRecording> states);
    void obey(const bus::RoomRecordOrder& order);
    Expected<void> start(const std::string& name);
    void look();
    void publish();

    std::string site_;
    std::filesystem::path folder_;
    record::RawRecorder& recorder_;
    bus::Waiter waiter_;
    bus::Reader<bus::RoomRecordOrder> orders_;
    bus::Writer<bus::RoomRecording> states_;
    bus::RoomRecording state_;
    std::filesystem::path current_;  // folder of the newest recording
    Clock::time_point begun_;
    bool has_stopped_ = false;  // by an order
};

}  // namespace atrium::site_node
