#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <new>

#include "commands.h"
#include "core/error.h"
#include "settings_file.h"
#include "stop.h"
#include "version.h"

int main(int argc, char** argv) {
    using namespace chromeball;
    handle_signals();
    CLI::App app{"Environment maps from photographs of mirror balls", "chromeball"};
    app.require_subcommand(1);
    app.fallthrough();
    app.set_version_flag("--version", std::string("chromeball ") + kVersion);
    app.config_formatter(std::make_shared<SettingsFile>(app));
    app.allow_config_extras(CLI::config_extras_mode::error);
    app.set_config("--config", "",
                   "Settings file (TOML): keys are option names, bare or in a [command] section");
    add_detect(app);
    add_convert(app);
    add_info(app);
    app.footer(
        "Each command has --help. Exit status: 0 done, 1 failed, 2 wrong words, 3 some of many "
        "failed, "
        "4 no ball found, 130 interrupted.");
    try {
        app.parse(argc, argv);
        return 0;
    } catch (const CLI::FileError& e) {
        fmt::print(stderr, "error: {}\n", e.what());
        return 1;
    } catch (const CLI::RuntimeError& e) {
        return e.get_exit_code();  // a command that has said all it has to say
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    } catch (const Error& e) {
        fmt::print(stderr, "error: {}\n", e.what());
        return static_cast<int>(e.kind());
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "error: not enough memory; use a smaller --size, or photo\n");
        return 1;
    } catch (const std::exception& e) {
        fmt::print(stderr, "error (unexpected): {}\n", e.what());
        return 1;
    }
}
