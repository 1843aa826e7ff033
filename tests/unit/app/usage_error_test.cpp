#include "core/app/usage_error.hpp"

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

namespace atrium::app {
namespace {

// What a program with the commands init, list and export, and --keys before and after them, says of
// these words.
std::string said_of(const std::string& words) {
    CLI::App cli("Makes keys.", "atrium keys");
    cli.require_subcommand(0, 1);
    std::string keys;
    bool json = false;
    cli.add_option("--keys", keys, "");
    for (const char* name : {"init", "list", "export"})
        cli.add_subcommand(name, "")->add_option("--keys", keys, "");
    cli.get_subcommand("list")->add_flag("--json", json, "");
    try {
        cli.parse(words);
    } catch (const CLI::ParseError& error) {
        return usage_error(cli, error);
    }
    return "fine";
}

TEST(UsageError, SuggestsTheCommandThatIsMeant) {
    EXPECT_EQ(said_of("int playroom"),
              "unknown command 'int': did you mean 'init'? `atrium keys --help` shows all");
    EXPECT_EQ(said_of("lst"),
              "unknown command 'lst': did you mean 'list'? `atrium keys --help` shows all");
    EXPECT_EQ(said_of("exprt alice -o alice.bundle"),
              "unknown command 'exprt': did you mean 'export'? `atrium keys --help` shows all");
    EXPECT_EQ(said_of("--keys kitchen.keys lst"),
              "unknown command 'lst': did you mean 'list'? `atrium keys --help` shows all");
    EXPECT_EQ(said_of("frobnicate"),
              "unknown command 'frobnicate': it must be one of init, list, export; `atrium keys "
              "--help` shows all");
}

TEST(UsageError, SuggestsTheOptionThatIsMeant) {
    EXPECT_EQ(said_of("list --jsn"),
              "unknown option '--jsn': did you mean '--json'? `atrium keys list --help` shows all");
    EXPECT_EQ(said_of("--kyes=x list"),
              "unknown option '--kyes': did you mean '--keys'? `atrium keys list --help` shows "
              "all");
    EXPECT_EQ(said_of("list -q"), "unknown option '-q'; `atrium keys list --help` shows all");
}

TEST(UsageError, NamesTheWordThatIsTooMuch) {
    EXPECT_EQ(said_of("list alice bob"),
              "one word too many: 'alice'; `atrium keys list --help` shows all");
}

TEST(UsageError, OtherwiseSaysWhatTheParserSays) {
    EXPECT_EQ(said_of("list --keys"),
              "--keys: 1 required TEXT missing; `atrium keys list --help` shows all");
    EXPECT_EQ(said_of("--keys a.keys list"), "fine");
}

}  // namespace
}  // namespace atrium::app
