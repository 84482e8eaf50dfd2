#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <iostream>
#include <new>

#include "commands.h"
#include "console.h"
#include "core/error.h"
#include "core/memory.h"
#include "settings_file.h"
#include "stop.h"
#include "usage.h"
#include "version.h"

int main(int argc, char** argv) {
    using namespace chromeball;
    keep_freed_memory();
    hold_standard_streams();
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
    add_shot(app);
    add_merge(app);
    add_preview(app);
    add_bake(app);
    add_stitch(app);
    add_calibrate(app);
    add_info(app);
    app.footer(
        "Each command has --help. Exit status: 0 done, 1 failed, 2 wrong words, 3 some of many "
        "failed, "
        "4 no ball found, 130 interrupted.");
    if (argc == 1) {
        print_message(app.help());
        return 2;
    }
    if (const auto word = option_without_value(argc, argv)) {
        print_message(fmt::format("error: {}: a value is missing behind the =\n", *word));
        return 2;
    }
    try {
        app.parse(argc, argv);
        return 0;
    } catch (const CLI::FileError& e) {
        print_message(fmt::format("error: {}; check the path of the settings file\n", e.what()));
        return 1;
    } catch (const CLI::RuntimeError& e) {
        return e.get_exit_code();  // a command that has said all it has to say
    } catch (const CLI::Success& e) {
        app.exit(e);  // prints the help or the version
        if (std::cout.flush()) return 0;
        print_message("error: standard output cannot be written\n");
        return 1;
    } catch (const CLI::ParseError& e) {
        print_message(fmt::format("error: {}\n", usage_message(app, e)));
        return 2;
    } catch (const Error& e) {
        print_message(fmt::format("error: {}\n", e.what()));
        return static_cast<int>(e.kind());
    } catch (const std::bad_alloc&) {
        print_message(fmt::format("error: not enough memory; use a smaller --size, or photo\n"));
        return 1;
    } catch (const std::exception& e) {
        print_message(fmt::format("error (unexpected): {}\n", e.what()));
        return 1;
    }
}
