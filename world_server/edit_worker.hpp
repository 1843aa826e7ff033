#pragma once

#include "world_server/command_inbox.hpp"
#include "world_server/config.hpp"
#include "world_server/outbox.hpp"
#include "world_server/saved_worlds.hpp"

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <tuple>

namespace atrium::world_server {

/// True if an edit needs files before it can be applied: it adds a model or loads a world.
bool needs_files(const bus::SceneEdit& edit);

/// An edit's result for its sender. `text` becomes one line of printable ASCII.
bus::EditResult result_of(const bus::SceneEdit& edit, bool is_done, const std::string& text);

/// Reads and writes the files of edits on its own thread, so that neither receiving nor simulating
/// waits for the disk. Hands edits that are ready to the command inbox, and results to the outbox.
/// At most 16 jobs wait. Thread-safe, except for `run`.
class EditWorker {
public:
    EditWorker(const WorldServerConfig& config, CommandInbox& commands, Outbox& outbox);

    /// Queues an edit for which `needs_files` holds. False if too many wait.
    bool prepare(bus::SceneEdit edit);
    /// Queues the writing of a saved world. False if too many wait.
    bool save(bus::SceneEdit edit, std::string text);
    const SavedWorldsFolder& folder() const { return folder_; }
    /// Does what waits now, instead of the thread.
    void do_waiting();
    /// Body of the thread.
    void run(std::stop_token stop);

private:
    struct Job {
        bus::SceneEdit edit;
        std::string text;  // of a world to write
    };
    struct Model {
        ModelParts parts;
        Fingerprint fingerprint;  // of the file that they were made from
    };
    bool put(Job job);
    void do_job(const Job& job);
    void add_model(const bus::SceneEdit& edit);
    void load(const bus::SceneEdit& edit);
    void write(const bus::SceneEdit& edit, const std::string& text);
    void refuse(const bus::SceneEdit& edit, const std::string& why);

    const WorldServerConfig& config_;
    CommandInbox& commands_;
    Outbox& outbox_;
    SavedWorldsFolder folder_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Job> jobs_;  // guarded by mutex_
    // by file, scale, shape; of the running thread only
    std::map<std::tuple<std::string, double, bus::Shape>, Model> models_;
};

}  // namespace atrium::world_server
