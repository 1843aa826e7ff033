#include "core/mcap/file.hpp"
#include "core/mcap/writer.hpp"
#include "core/recording/cursor.hpp"
#include "core/recording/moment.hpp"
#include "tests/fuzz/file_check.hpp"
#include "tests/fuzz/file_folder.hpp"

#include <algorithm>

namespace atrium::test {
namespace {

namespace fs = std::filesystem;

bool is_inside(std::span<const std::byte> part, std::span<const std::byte> whole) {
    return part.empty() || (part.data() >= whole.data() &&
                            part.data() + part.size() <= whole.data() + whole.size());
}

std::string check_chunks(const mcap::File& file, std::uint64_t& num_messages) {
    for (std::size_t i = 0; i < file.contents().chunks.size(); ++i) {
        const auto chunk = file.read(i);
        if (!chunk) {
            const std::string& why = chunk.error().message;
            if (why.find(file.path().string() + ": chunk ") != 0)
                return "an error without its chunk";
            continue;
        }
        num_messages += chunk->messages.size();
        if (!std::ranges::is_sorted(chunk->messages, {}, &mcap::Message::log_time))
            return "messages out of order";
        for (const mcap::Message& message : chunk->messages) {
            if (!is_inside(message.data, chunk->records)) return "a message outside of its chunk";
        }
    }
    return "";
}

std::string check_repair(const fs::path& copy, const mcap::File& file, std::uint64_t num_messages) {
    if (!mcap::repair(copy)) return "";
    const auto repaired = mcap::File::open(copy);
    if (!repaired) return "cannot be opened after the repair: " + repaired.error().message;
    if (!repaired->fault().empty()) return "a fault after the repair: " + repaired->fault();
    std::uint64_t num_repaired = 0;
    if (const std::string wrong = check_chunks(*repaired, num_repaired); !wrong.empty())
        return wrong;
    // A summary may be wrong where the file is right.
    if (!file.fault().empty() && num_repaired != num_messages)
        return "other messages after the repair";
    return "";
}

std::string check_world(const std::shared_ptr<const recording::WorldFile>& world,
                        std::uint64_t num_messages) {
    recording::Cursor cursor(world);
    std::uint64_t num_played = 0;
    for (const recording::PlayedSample* next = cursor.peek(); next != nullptr;
         next = cursor.peek()) {
        ++num_played;
        if (next->topic == nullptr) return "a sample without a topic";
        static_cast<void>(next->topic->key_of(next->raw));
        cursor.pop();
    }
    if (num_played > num_messages) return "more samples than messages";
    for (int i = 0; i <= 4; ++i) {
        const Timestamp time = world->begin() + world->duration() / 4 * i;
        for (const recording::KeyedSample& one : recording::moment(world, time)) {
            const auto key = one.sample.topic->key_of(one.sample.raw);
            if (!key || *key != one.key) return "a moment with another key";
        }
    }
    return "";
}

}  // namespace

std::string check_recording_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    was_accepted = false;
    const fs::path path = folder().write("a.mcap", bytes);
    const auto file = mcap::File::open(path);
    if (!file) {
        if (mcap::repair(folder().write("b.mcap", bytes))) return "repairs what cannot be opened";
        return file.error().message.find("a.mcap: ") == std::string::npos
                   ? "an error without the file"
                   : "";
    }
    std::uint64_t num_messages = 0;
    if (std::string wrong = check_chunks(*file, num_messages); !wrong.empty()) return wrong;
    const auto world = recording::WorldFile::open(path);
    was_accepted = world.has_value();
    if (world) {
        if (std::string wrong = check_world(*world, num_messages); !wrong.empty()) return wrong;
    }
    return check_repair(folder().write("b.mcap", bytes), *file, num_messages);
}

}  // namespace atrium::test
