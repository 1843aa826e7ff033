#pragma once

#include <cstddef>
#include <type_traits>

namespace atrium {

/// Runs independent tasks. Libraries receive an executor; only programs own its threads.
class Executor {
public:
    /// Refers to a task body, called as `(task, worker)` with worker < num_workers(). A view: does
    /// not own the callable.
    class Body {
    public:
        template <typename F>
        requires(!std::is_same_v<std::remove_const_t<F>, Body>)
            // NOLINTNEXTLINE(google-explicit-constructor): lambdas convert to it
            Body(F& body)
            : context_(const_cast<void*>(static_cast<const void*>(&body))),
              call_([](void* context, std::size_t task, std::size_t worker) {
                  (*static_cast<F*>(context))(task, worker);
              }) {}
        void operator()(std::size_t task, std::size_t worker) const {
            call_(context_, task, worker);
        }

    private:
        void* context_;
        void (*call_)(void*, std::size_t, std::size_t);
    };

    virtual ~Executor() = default;

    /// At least 1. Two tasks that run at the same time have different worker numbers.
    virtual std::size_t num_workers() const = 0;

    /// Calls `body` once for every task in [0, num_tasks), in any order, and returns when all are
    /// done. Rethrows the first exception of `body` (such as std::bad_alloc) after all workers have
    /// left `body`; some tasks may then not have run.
    virtual void parallel_for(std::size_t num_tasks, Body body) = 0;

    /// Lets more urgent tasks of other callers run before it returns. Long tasks call it every few
    /// tens of microseconds with their worker number.
    virtual void give_way(std::size_t /*worker*/) {}
};

/// Binds `Executor::give_way` to one task, to pass it to the long functions of that task. Does
/// nothing without an executor.
struct GiveWay {
    Executor* executor = nullptr;
    std::size_t worker = 0;

    void operator()() const {
        if (executor != nullptr) executor->give_way(worker);
    }
};

/// Runs all tasks in order on the calling thread.
class SerialExecutor final : public Executor {
public:
    std::size_t num_workers() const override { return 1; }
    void parallel_for(std::size_t num_tasks, Body body) override {
        for (std::size_t task = 0; task < num_tasks; ++task) body(task, 0);
    }
};

}  // namespace atrium
