#include "world_server/edit_worker.hpp"

#include "core/app/log.hpp"
#include "core/base/readable.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "core/model/model_file.hpp"
#include "world_server/description/doubts.hpp"
#include "world_server/description/texture_fingerprints.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace atrium::world_server {
namespace {

constexpr std::size_t kMaxJobs = 16;
constexpr std::size_t kMaxModels = 64;  // kept for further objects

}  // namespace

bool needs_files(const bus::SceneEdit& edit) {
    if (edit.kind == bus::EditKind::kLoadWorld) return true;
    const bool is_model =
        edit.object.shape == bus::Shape::kConvex || edit.object.shape == bus::Shape::kCompound;
    return edit.kind == bus::EditKind::kAdd && edit.target == 0 && is_model;
}

bus::EditResult result_of(const bus::SceneEdit& edit, bool is_done, const std::string& text) {
    bus::EditResult result;
    result.sender = edit.sender;
    result.number = edit.number;
    result.is_done = is_done;
    result.object = edit.target;
    result.text = text.substr(0, bus::kMaxTextLength);
    for (char& c : result.text)
        if (c < ' ' || c > '~') c = '?';
    return result;
}

EditWorker::EditWorker(const WorldServerConfig& config, CommandInbox& commands, Outbox& outbox)
    : config_(config),
      commands_(commands),
      outbox_(outbox),
      folder_(config.saved_folder, static_cast<std::size_t>(config.max_saved)) {}

bool EditWorker::put(Job job) {
    {
        const std::lock_guard lock(mutex_);
        if (jobs_.size() >= kMaxJobs) return false;
        jobs_.push_back(std::move(job));
    }
    changed_.notify_one();
    return true;
}

bool EditWorker::prepare(bus::SceneEdit edit) { return put({std::move(edit), {}}); }

bool EditWorker::save(bus::SceneEdit edit, std::string text) {
    return put({std::move(edit), std::move(text)});
}

void EditWorker::refuse(const bus::SceneEdit& edit, const std::string& why) {
    app::log::warn("edit_refused by={} {}", edit.sender, why);
    outbox_.put(result_of(edit, false, why));
}

void EditWorker::add_model(const bus::SceneEdit& edit) {
    const bus::SceneObject& object = edit.object;
    if (config_.models_folder.empty()) {
        return refuse(edit,
                      "the world server has no folder of models: it was started without a world "
                      "file");
    }
    if (!model::is_model_name(object.model)) {
        return refuse(edit,
                      fmt::format("{}: must be a {} file", object.model, model::model_endings()));
    }
    const std::filesystem::path file = config_.models_folder / object.model;
    const auto readable = check_readable(file);
    if (!readable && readable.error().kind != ErrorKind::kNotFound)
        return refuse(edit, readable.error().message);
    if (!readable) {
        return refuse(edit,
                      fmt::format("the world server has no model {} in its folder: copy the file "
                                  "there, below the world file",
                                  object.model));
    }
    if (models_.size() >= kMaxModels) models_.clear();
    Model& model = models_[{object.model, object.model_scale, object.shape}];
    if (!model.parts) {
        auto loaded = load_model_parts(
            file, object.model_scale, static_cast<physics::ObjectShape>(object.shape));
        if (!loaded) return refuse(edit, loaded.error().message);
        model = {std::move(loaded->parts), loaded->fingerprint};
    }
    PreparedEdit prepared{edit, model.parts, nullptr};
    prepared.edit.object.model_fingerprint = model.fingerprint;
    prepared.edit.object.texture_fingerprint =
        texture_fingerprint(config_.models_folder, object.texture);
    if (!commands_.put_prepared(std::move(prepared))) refuse(edit, "too many edits at once");
}

void EditWorker::load(const bus::SceneEdit& edit) {
    auto loaded = folder_.load(edit.world_file, config_);
    if (!loaded) return refuse(edit, loaded.error().message);
    for (const std::string& doubt : doubts_about(*loaded, config_.tick_hz))
        app::log::warn("{}", doubt);
    const auto world = std::make_shared<const WorldServerConfig>(std::move(*loaded));
    if (!commands_.put_prepared({edit, nullptr, world})) refuse(edit, "too many edits at once");
}

void EditWorker::write(const bus::SceneEdit& edit, const std::string& text) {
    if (const auto saved = folder_.save(edit.world_file, text); !saved)
        return refuse(edit, saved.error().message);
    app::log::info("world_saved name={} by={} bytes={} folder={}",
                   edit.world_file,
                   edit.sender,
                   text.size(),
                   folder_.folder().string());
    outbox_.put(result_of(edit, true, {}));
    outbox_.put(folder_.list(config_.bus.world));
}

void EditWorker::do_job(const Job& job) {
    if (job.edit.kind == bus::EditKind::kAdd)
        add_model(job.edit);
    else if (job.edit.kind == bus::EditKind::kLoadWorld)
        load(job.edit);
    else
        write(job.edit, job.text);
}

void EditWorker::do_waiting() {
    while (true) {
        Job job;
        {
            const std::lock_guard lock(mutex_);
            if (jobs_.empty()) return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        do_job(job);
    }
}

void EditWorker::run(std::stop_token stop) {
    outbox_.put(folder_.list(config_.bus.world));
    while (true) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, stop, [this] { return !jobs_.empty(); })) return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        do_job(job);
    }
}

}  // namespace atrium::world_server
