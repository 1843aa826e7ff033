#include "core/recording/world_file.hpp"

#include "core/bus/messages.hpp"
#include "core/bus/names.hpp"
#include "core/recording/topic_roles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace atrium::recording {
namespace {

const mcap::Metadata* own_metadata(const mcap::File& file) {
    const auto& all = file.contents().metadata;
    const auto own = std::ranges::find(all, "atrium", &mcap::Metadata::name);
    return own == all.end() ? nullptr : &*own;
}

std::string entry(const mcap::File& file, const std::string& key) {
    const mcap::Metadata* const metadata = own_metadata(file);
    if (metadata == nullptr) return {};
    const auto found = metadata->entries.find(key);
    return found == metadata->entries.end() ? "" : bus::as_line(found->second);
}

// A copy of the chosen messages: chunks of other programs have them among pictures.
std::shared_ptr<const mcap::Chunk> only(const mcap::Chunk& chunk,
                                        const std::vector<std::size_t>& chosen) {
    auto copy = std::make_shared<mcap::Chunk>();
    std::size_t size = 0;
    for (const std::size_t i : chosen) size += chunk.messages[i].data.size();
    copy->records.reserve(size);
    for (const std::size_t i : chosen) {
        mcap::Message message = chunk.messages[i];
        const std::size_t at = copy->records.size();
        copy->records.insert(copy->records.end(), message.data.begin(), message.data.end());
        message.data = std::span(copy->records).subspan(at, message.data.size());
        copy->messages.push_back(message);
    }
    return copy;
}

RecordedChannel channel_named(std::string_view topic) {
    RecordedChannel channel;
    if (topic.ends_with("/disposed")) channel.kind = bus::RawKind::kDisposed;
    if (topic.ends_with("/lost")) channel.kind = bus::RawKind::kLost;
    channel.topic = bus::find_raw_topic(topic.substr(0, topic.find('/')));
    return channel;
}

}  // namespace

Expected<std::shared_ptr<const WorldFile>> WorldFile::open(const std::filesystem::path& path,
                                                           std::size_t max_kept_bytes) {
    std::error_code unknown;
    if (std::filesystem::is_directory(path, unknown)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: it is a folder; a recording of a world is a file, and "
                                      "`site_node --recording` plays the folder of a room",
                                      path.string()));
    }
    auto file = mcap::File::open(path);
    if (!file) return tl::unexpected(file.error());
    std::shared_ptr<WorldFile> world(new WorldFile(std::move(*file)));
    if (auto read = world->read_channels(); !read) return tl::unexpected(read.error());
    world->read_kept(max_kept_bytes);
    return world;
}

std::string WorldFile::world() const {
    const std::string name = entry(file_, "world");
    return name.empty() ? "atrium" : name;
}

std::string WorldFile::version() const { return entry(file_, "version"); }

Expected<void> WorldFile::read_channels() {
    const mcap::Contents& contents = file_.contents();
    std::set<std::string> foreign;
    bool has_any = false;
    for (const auto& [id, channel] : contents.channels) {
        RecordedChannel known = channel_named(channel.topic);
        if (channel.message_encoding != "cdr") known.topic = nullptr;
        has_any = has_any || known.topic != nullptr;
        channels_[id] = known;
        const auto schema = contents.schemas.find(channel.schema);
        const bool is_ours = schema != contents.schemas.end() && schema->second.data == bus::kIdl;
        if (known.topic != nullptr && !is_ours) foreign.insert(std::string(known.topic->name()));
    }
    if (!has_any) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: it is no recording of Atrium: it has none of its topics",
                                      file_.path().string()));
    }
    foreign_topics_.assign(foreign.begin(), foreign.end());
    begin_ = contents.chunks.front().first;
    end_ = contents.chunks.front().last;
    for (const mcap::ChunkIndex& chunk : contents.chunks) {
        begin_ = std::min(begin_, chunk.first);
        end_ = std::max(end_, chunk.last);
    }
    return {};
}

// Damaged chunks are left out here; playing them tells.
void WorldFile::read_kept(std::size_t max_bytes) {
    const auto& chunks = file_.contents().chunks;
    std::size_t num_bytes = 0;
    std::set<std::string> sites;
    std::map<std::string, RecordedProgram> programs;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        const auto& indexes = chunks[i].message_indexes;  // none: it has to be looked into
        const bool may_have = indexes.empty() || std::ranges::any_of(indexes, [&](const auto& one) {
                                  const RecordedChannel known = channel(one.first);
                                  return known.topic != nullptr && is_kept(*known.topic);
                              });
        if (!may_have) continue;
        if (num_bytes >= max_bytes) {
            kept_until_ = chunks[i].first;
            break;
        }
        auto read = file_.read(i);
        if (!read) continue;
        std::vector<std::size_t> chosen;
        for (std::size_t k = 0; k < read->messages.size(); ++k) {
            const RecordedChannel known = channel(read->messages[k].channel);
            if (known.topic != nullptr && is_kept(*known.topic)) chosen.push_back(k);
        }
        const auto chunk = only(*read, chosen);
        for (const mcap::Message& message : chunk->messages) {
            const RecordedChannel known = channel(message.channel);
            const bus::RawSample raw{known.kind, message.publish_time, message.data};
            auto key = known.topic->key_of(raw);
            if (!key) continue;  // refused when it is played
            if (known.topic->name() == "SiteDescription") sites.insert(*key);
            if (known.topic->name() == "Presence" && known.kind == bus::RawKind::kSample) {
                if (const auto program = bus::from_raw<bus::Presence>(raw))
                    programs[*key] = {
                        program->kind, program->name, program->host, program->version};
            }
            num_bytes += message.data.size() + sizeof(Kept);
            kept_.push_back({{message.log_time, known.topic, raw, chunk}, std::move(*key)});
        }
    }
    std::ranges::stable_sort(kept_, {}, [](const Kept& kept) { return kept.sample.time; });
    sites_.assign(sites.begin(), sites.end());
    for (auto& [key, program] : programs) programs_.push_back(std::move(program));
}

std::map<std::string, std::uint64_t> WorldFile::num_samples() const {
    std::map<std::string, std::uint64_t> nums;
    for (const auto& [id, num] : file_.contents().num_messages) {
        const RecordedChannel known = channel(id);
        if (known.topic != nullptr && known.kind == bus::RawKind::kSample)
            nums[std::string(known.topic->name())] += num;
    }
    return nums;
}

std::vector<std::string> WorldFile::warnings() const {
    std::vector<std::string> lines;
    const std::string name = file_.path().string();
    if (file_.is_being_written()) {
        lines.push_back(fmt::format("still_written file={}: what comes later is left out", name));
    } else if (!file_.fault().empty()) {
        lines.push_back(
            fmt::format("damaged file={} reason=\"{}\"; all whole chunks are used; `atrium play {} "
                        "--repair` completes the file",
                        name,
                        file_.fault(),
                        name));
    }
    if (kept_until_ != Timestamp{}) {
        lines.push_back(
            fmt::format("too_much_kept file={} from_s={:.1f}: descriptions, placements and models "
                        "from then on are left out; record with --cut_s",
                        name,
                        std::chrono::duration<double>(kept_until_ - begin_).count()));
    }
    if (!foreign_topics_.empty()) {
        lines.push_back(fmt::format(
            "other_version recorded_by={} topics={}: samples that do not fit are left out",
            version(),
            fmt::join(foreign_topics_, ",")));
    }
    return lines;
}

RecordedChannel WorldFile::channel(std::uint16_t id) const {
    const auto found = channels_.find(id);
    return found == channels_.end() ? RecordedChannel{} : found->second;
}

}  // namespace atrium::recording
