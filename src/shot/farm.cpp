#include "shot/farm.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/error.h"
#include "core/names.h"

namespace chromeball {
namespace {

/// "%" begins a replacement symbol, "%%" is itself; a backslash turns all of them off.
std::optional<std::string> slurm_log_folder(std::string_view folder) {
    std::string text;
    for (const char c : folder) {
        if (c == '\\') return std::nullopt;
        text.append(c == '%' ? 2 : 1, c);
    }
    return text;
}

std::string filled(std::string_view word, std::string_view value) {
    return fmt::format(fmt::runtime(word), value);
}

/// Whose words a task gets from here, not from the user.
const std::vector<std::pair<std::string_view, int>> kOurs = {
    {"--frames", 1}, {"--stage", 1},       {"--farm", 1},   {"--chunk", 1},
    {"--jobs", 1},   {"--farm-option", 1}, {"--report", 1}, {"--farm-dry-run", 0}};

std::string_view option_of(std::string_view word) { return word.substr(0, word.find('=')); }

/// The options among the words that are of a name, with their values.
std::vector<std::string> words_of(const std::vector<std::string>& words, std::string_view option) {
    std::vector<std::string> some;
    for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
        if (option_of(words[i]) != option) continue;
        some.push_back(words[i]);
        if (words[i] == option && i + 1 < words.size()) some.push_back(words[++i]);
    }
    return some;
}

std::string command_line(std::span<const std::string> words) {
    std::string text;
    for (const std::string& word : words) {
        if (!text.empty()) text += ' ';
        text += quoted_for_shell(word);
    }
    return text;
}

/// A text as a here-document of a function that prints it.
std::string printing_function(const std::string& name, const std::string& text, std::string mark) {
    while (("\n" + text).find("\n" + mark + "\n") != std::string::npos) mark += '_';
    return fmt::format("{}() {{\n    cat <<'{}'\n{}{}\n}}\n", name, mark, text, mark);
}

/// The program with the user's words and the stage's, for sh; `frames` stands as it is.
std::string stage_command(const FarmKind& kind, const FarmShot& shot, std::string_view stage,
                          const std::string& frames, std::span<const std::string> more = {}) {
    const std::vector<std::string> words = words_without(shot.words, kOurs);
    const std::string jobs = shot.jobs ? fmt::format("{}", *shot.jobs)
                                       : fmt::format("\"${{{}:-1}}\"", kind.processors_variable);
    // Ours go in front of "--", behind which there are no options.
    const auto options =
        static_cast<std::size_t>(std::find(words.begin(), words.end(), "--") - words.begin());
    std::string text = quoted_for_shell(shot.program);
    for (const std::string& part :
         {command_line(std::span(words).first(options)),
          fmt::format("--farm none --stage {} --jobs {} --frames {}", stage, jobs, frames),
          command_line(more), command_line(std::span(words).subspan(options))}) {
        if (part.empty()) continue;
        text += ' ';
        text += part;
    }
    return text;
}

std::string array_script(const FarmKind& kind, const FarmShot& shot, std::string_view stage,
                         const std::vector<Frames>& chunks, std::size_t first, std::size_t end) {
    std::string lines;
    for (std::size_t i = first; i < end; ++i) lines += text_of(chunks[i]) + '\n';
    return fmt::format(
        "#!/bin/sh\n# chromeball: {}, a chunk of frames a task\n{}"
        "frames=$(chunks | sed -n \"$(({} + 1))p\")\n"
        "[ -n \"$frames\" ] || {{ echo \"there is no chunk of this index\" >&2; exit 1; }}\n"
        "exec {}\n",
        stage, printing_function("chunks", lines, "CHUNKS"), kind.index_variable,
        stage_command(kind, shot, stage, "\"$frames\""));
}

/// Adds a stage's arrays, as many as the farm's limit wants; gives their places.
std::vector<std::size_t> add_arrays(std::vector<FarmJob>& jobs, const FarmKind& kind,
                                    const FarmShot& shot, std::string_view stage,
                                    const std::vector<std::size_t>& after) {
    const std::vector<Frames> chunks = chunks_of(shot.frames, shot.chunk);
    const auto most = static_cast<std::size_t>(kind.most_tasks);
    std::vector<std::size_t> places;
    for (std::size_t first = 0; first < chunks.size(); first += most) {
        const std::size_t end = std::min(first + most, chunks.size());
        FarmJob job;
        job.name = chunks.size() <= most ? std::string(stage)
                                         : fmt::format("{}.{}", stage, places.size() + 1);
        job.script = array_script(kind, shot, stage, chunks, first, end);
        job.tasks = end - first;
        job.after = after;
        job.only_after_success = !after.empty();
        places.push_back(jobs.size());
        jobs.push_back(std::move(job));
    }
    return places;
}

/// The words of a submission but for what it waits for.
std::vector<std::string> submission(const FarmKind& kind, const FarmShot& shot,
                                    const FarmJob& job) {
    const auto logs = kind.log_folder(shot.logs);
    if (!logs)
        throw Error(Error::Kind::usage,
                    fmt::format("{}: {} cannot write logs to a folder of that name; choose another "
                                "one with --work",
                                excerpt(shot.logs), kind.name));
    std::vector<std::string> words(kind.submit.begin(), kind.submit.end());
    words.push_back(filled(kind.job_name, "chromeball-" + job.name));
    words.push_back(filled(kind.folder, shot.folder));
    words.push_back(filled(job.tasks > 0 ? kind.array_log : kind.log, *logs));
    if (shot.jobs) words.push_back(filled(kind.processors, fmt::format("{}", *shot.jobs)));
    if (job.tasks > 0) words.push_back(filled(kind.array, fmt::format("{}", job.tasks - 1)));
    words.insert(words.end(), shot.options.begin(), shot.options.end());
    return words;
}

std::string waiting_word(const FarmKind& kind, const FarmJob& job,
                         const std::vector<std::string>& numbers) {
    std::string list;
    for (const std::size_t place : job.after) {
        if (!list.empty()) list += kind.between_numbers;
        list += numbers[place];
    }
    return filled(job.only_after_success ? kind.after_success : kind.after_any, list);
}

/// The number at the beginning of what the farm's program prints: "1234" or "1234;cluster".
std::string number_in(std::string_view printed) {
    const std::size_t end = printed.find_first_not_of("0123456789");
    return std::string(printed.substr(0, end));
}

}  // namespace

const std::vector<FarmKind>& farm_kinds() {
    static const std::vector<FarmKind> kinds = {
        {.name = "slurm",
         // A job that can never start must not wait for ever; a machine that dies gives its tasks
         // back, and what they said before is kept.
         .submit = {"sbatch", "--parsable", "--kill-on-invalid-dep=yes", "--requeue",
                    "--open-mode=append"},
         .cancel = "scancel",
         .job_name = "--job-name={}",
         .folder = "--chdir={}",
         .log = "--output={}/%x.%j.log",
         .array_log = "--output={}/%x.%A_%a.log",
         .array = "--array=0-{}",
         .processors = "--cpus-per-task={}",
         .after_any = "--dependency=afterany:{}",
         .after_success = "--dependency=afterok:{}",
         .between_numbers = ":",
         .index_variable = "SLURM_ARRAY_TASK_ID",
         .processors_variable = "SLURM_CPUS_PER_TASK",
         .most_tasks = 1000,  // MaxArraySize is 1001 where nobody has set it
         .log_folder = slurm_log_folder},
    };
    return kinds;
}

const FarmKind& farm_kind(std::string_view name) {
    std::vector<std::string> names;
    for (const FarmKind& kind : farm_kinds()) {
        if (kind.name == name) return kind;
        names.emplace_back(kind.name);
    }
    throw Error(Error::Kind::usage, fmt::format("--farm {}: no such farm; there is {}",
                                                excerpt(name), quoted_list(names)));
}

std::vector<Frames> chunks_of(const Frames& frames, int most) {
    std::vector<Frames> chunks;
    for (std::size_t i = 0; i < frames.size();) {
        std::size_t end = i + 1;
        while (end < frames.size() && block_of(frames[end]) == block_of(frames[i])) ++end;
        if (chunks.empty() ||
            chunks.back().size() + (end - i) > static_cast<std::size_t>(std::max(most, 1)))
            chunks.emplace_back();
        chunks.back().insert(chunks.back().end(), frames.begin() + static_cast<std::ptrdiff_t>(i),
                             frames.begin() + static_cast<std::ptrdiff_t>(end));
        i = end;
    }
    return chunks;
}

std::string quoted_for_shell(std::string_view word) {
    constexpr std::string_view kPlain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./:,@%";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos)
        return std::string(word);
    std::string text = "'";
    for (const char c : word) {
        if (c == '\'')
            text += "'\\''";
        else
            text += c;
    }
    return text + "'";
}

std::vector<std::string> words_without(
    const std::vector<std::string>& words,
    const std::vector<std::pair<std::string_view, int>>& options) {
    std::vector<std::string> kept;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--") {
            kept.insert(kept.end(), words.begin() + static_cast<std::ptrdiff_t>(i), words.end());
            break;
        }
        const auto option = std::find_if(options.begin(), options.end(), [&](const auto& o) {
            return o.first == option_of(words[i]);
        });
        if (option == options.end())
            kept.push_back(words[i]);
        else if (words[i] == option->first)
            i += static_cast<std::size_t>(option->second);
    }
    return kept;
}

std::vector<FarmJob> farm_jobs(const FarmKind& kind, const FarmShot& shot) {
    std::vector<FarmJob> jobs;
    const auto tracks = add_arrays(jobs, kind, shot, "track", {});

    FarmJob solve;
    solve.name = "solve";
    solve.after = tracks;
    // 3: some frames failed. They stand in the report, and the others are to be converted.
    solve.script = fmt::format(
        "#!/bin/sh\n# chromeball: solve, all frames\n{}\nstatus=$?\n"
        "[ \"$status\" -eq 3 ] && exit 0\nexit \"$status\"\n",
        stage_command(kind, shot, "solve", text_of(shot.frames)));
    const std::size_t solve_place = jobs.size();
    jobs.push_back(std::move(solve));

    FarmJob report;
    report.name = "report";
    report.after = add_arrays(jobs, kind, shot, "convert", {solve_place});
    report.script = fmt::format("#!/bin/sh\n# chromeball: report, all frames\nexec {}\n",
                                stage_command(kind, shot, "report", text_of(shot.frames),
                                              words_of(shot.words, "--report")));
    jobs.push_back(std::move(report));
    return jobs;
}

std::string dry_run(const FarmKind& kind, const FarmShot& shot, const std::vector<FarmJob>& jobs) {
    std::string text = fmt::format(
        "#!/bin/sh\n# {} frames in chunks of {}; what follows submits them.\nset -e\nmkdir -p {}\n",
        shot.frames.size(), shot.chunk, quoted_for_shell(shot.logs));
    std::vector<std::string> numbers;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        text += '\n' + printing_function(fmt::format("script_{}", i), jobs[i].script, "SCRIPT");
        text += fmt::format("job_{0}=$(script_{0} | {1}", i,
                            command_line(submission(kind, shot, jobs[i])));
        if (!jobs[i].after.empty())
            text += fmt::format(" \"{}\"", waiting_word(kind, jobs[i], numbers));
        text += fmt::format(")\necho \"{}: ${{job_{}}}\"\n", jobs[i].name, i);
        numbers.push_back(fmt::format("${{job_{}%%;*}}", i));
    }
    return text;
}

std::vector<std::string> submit(const FarmKind& kind, const FarmShot& shot,
                                const std::vector<FarmJob>& jobs, const RunProgram& run) {
    std::vector<std::string> numbers;
    const auto refuse = [&](const FarmJob& job, const std::string& why) {
        std::string done;
        for (const std::string& number : numbers) done += ' ' + number;
        if (!done.empty())
            done = fmt::format("; jobs{0} are submitted already, \"{1}{0}\" ends them", done,
                               kind.cancel);
        throw Error(Error::Kind::failed, fmt::format("{}: {} took no job {}: {}{}", kind.name,
                                                     kind.submit.front(), job.name, why, done));
    };
    for (const FarmJob& job : jobs) {
        std::vector<std::string> words = submission(kind, shot, job);
        if (!job.after.empty()) words.push_back(waiting_word(kind, job, numbers));
        const ProgramOutcome outcome = run(words, job.script);
        const std::string said(outcome.err.substr(0, outcome.err.find('\n')));
        if (outcome.status == 127) refuse(job, "there is no such program on this machine");
        if (outcome.status != 0)
            refuse(job, fmt::format("status {}, \"{}\"", outcome.status, said));
        std::string number = number_in(outcome.out);
        if (number.empty())
            refuse(job, fmt::format("it printed no job's number but \"{}\"", excerpt(outcome.out)));
        numbers.push_back(std::move(number));
    }
    return numbers;
}

}  // namespace chromeball
