#include "shot/farm.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <numeric>

#include "cli/program.h"
#include "core/error.h"
#include "run_program.h"

namespace chromeball::test {
namespace {

Frames range(int first, int last) {
    Frames frames(static_cast<std::size_t>(last - first + 1));
    std::iota(frames.begin(), frames.end(), first);
    return frames;
}

FarmShot a_shot(Frames frames = range(1001, 1100)) {
    FarmShot shot;
    shot.program = "/opt/chromeball";
    shot.words = {"shot",       "p.####.exr", "--frames", "1001-1100",      "-o",
                  "q.####.exr", "--farm",     "slurm",    "--report=r.html"};
    shot.frames = std::move(frames);
    shot.chunk = 32;
    shot.folder = "/shots/10";
    shot.logs = "/shots/10/.chromeball/farm";
    return shot;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

int block_of(int frame) { return (frame - (frame % 16 + 16) % 16) / 16; }

TEST(Chunks, HoldEveryFrameOnceInOrderAndPartNoBlockOfSixteen) {
    Frames sparse;
    for (int f = -40; f < 3000; f += 7) sparse.push_back(f);
    for (const Frames& frames : {range(1001, 1100), range(0, 0), sparse, Frames{}})
        for (const int most : {1, 16, 33, 100, 5000}) {
            const std::vector<Frames> chunks = chunks_of(frames, most);
            Frames joined;
            for (std::size_t i = 0; i < chunks.size(); ++i) {
                ASSERT_FALSE(chunks[i].empty());
                joined.insert(joined.end(), chunks[i].begin(), chunks[i].end());
                if (i > 0) {
                    EXPECT_NE(block_of(chunks[i].front()), block_of(chunks[i - 1].back()));
                }
                const bool one_block = block_of(chunks[i].front()) == block_of(chunks[i].back());
                EXPECT_TRUE(one_block || chunks[i].size() <= static_cast<std::size_t>(most));
            }
            EXPECT_EQ(joined, frames);
        }
}

TEST(Chunks, AreAsLargeAsTheyMayBe) {
    const auto chunks = chunks_of(range(1001, 1100), 32);
    ASSERT_EQ(chunks.size(), 4u);
    EXPECT_EQ(chromeball::text_of(chunks[0]), "1001-1023");  // 992-1007 and 1008-1023
    EXPECT_EQ(chromeball::text_of(chunks[1]), "1024-1055");
    EXPECT_EQ(chromeball::text_of(chunks[2]), "1056-1087");
    EXPECT_EQ(chromeball::text_of(chunks[3]), "1088-1100");
}

const std::vector<std::string> kNastyWords = {
    "",   " ",    "a b", "it's",  "'",  "\"$HOME\"", "`id`",      "$(id)",
    "\\", "a\nb", "*",   "~",     "#x", "-n",        "a;b|c&d>e", "\xFF\xC3\x28",
    "!x", "=",    "@",   "{a,b}", "\t", "%s%n",      "SCRIPT",    "x\nSCRIPT\ny"};

TEST(QuotedWords, ReachAProgramAsTheyAre) {
    const TempFolder folder;
    std::string script = "printf '%s\\0'";
    std::string wanted;
    for (const std::string& word : kNastyWords) {
        script += ' ' + quoted_for_shell(word);
        wanted += word + '\0';
    }
    write_bytes(folder / "script", script + "\n");
    EXPECT_EQ(run_other(folder, {"sh", "script"}).out, wanted);
    EXPECT_EQ(quoted_for_shell("plates/sh010.%04d.exr"), "plates/sh010.%04d.exr");
}

TEST(WordsWithout, DropOptionsWithTheirValues) {
    const std::vector<std::pair<std::string_view, int>> options = {{"--frames", 1}, {"--flag", 0}};
    EXPECT_EQ(
        words_without({"a", "--frames", "1-2", "--frames=3", "--flag", "b", "--framesx"}, options),
        (std::vector<std::string>{"a", "b", "--framesx"}));
    EXPECT_EQ(words_without({"--", "--frames", "x"}, options),
              (std::vector<std::string>{"--", "--frames", "x"}));
    EXPECT_EQ(words_without({"--frames"}, options), std::vector<std::string>{});
}

TEST(FarmJobs, WaitForEachOtherSoThatOnlyAFailedSolveStopsTheRest) {
    const auto jobs = farm_jobs(farm_kind("slurm"), a_shot());
    ASSERT_EQ(jobs.size(), 4u);
    EXPECT_EQ(jobs[0].name, "track");
    EXPECT_EQ(jobs[0].tasks, 4u);
    EXPECT_TRUE(jobs[0].after.empty());
    EXPECT_EQ(jobs[1].name, "solve");
    EXPECT_EQ(jobs[1].tasks, 0u);
    EXPECT_EQ(jobs[1].after, std::vector<std::size_t>{0});
    EXPECT_FALSE(jobs[1].only_after_success);
    EXPECT_EQ(jobs[2].name, "convert");
    EXPECT_EQ(jobs[2].tasks, 4u);
    EXPECT_EQ(jobs[2].after, std::vector<std::size_t>{1});
    EXPECT_TRUE(jobs[2].only_after_success);
    EXPECT_EQ(jobs[3].name, "report");
    EXPECT_EQ(jobs[3].after, std::vector<std::size_t>{2});
    EXPECT_FALSE(jobs[3].only_after_success);
}

TEST(FarmJobs, SplitArraysThatAFarmWouldRefuse) {
    FarmShot shot = a_shot(range(1, 100'000));
    shot.chunk = 16;
    const auto jobs = farm_jobs(farm_kind("slurm"), shot);
    ASSERT_EQ(jobs.size(), 7u + 1 + 7 + 1);
    std::size_t tasks = 0;
    for (const FarmJob& job : jobs) {
        EXPECT_LE(job.tasks, 1000u);
        tasks += job.tasks;
        EXPECT_LT(job.script.size(), 4u << 20) << "Slurm's MaxScriptSize";
    }
    EXPECT_EQ(tasks, 2u * 6251);
    EXPECT_EQ(jobs[7].name, "solve");
    EXPECT_EQ(jobs[7].after.size(), 7u);
    EXPECT_EQ(jobs[8].name, "convert.1");
    EXPECT_EQ(jobs.back().after.size(), 7u);
}

TEST(FarmJobs, ReportOnceWithWhatTheUserAskedFor) {
    const auto jobs = farm_jobs(farm_kind("slurm"), a_shot());
    for (const FarmJob& job : jobs)
        EXPECT_EQ(count(job.script, "--report"), job.name == "report" ? 1u : 0u) << job.name;
}

/// Runs a job's script with a program that prints its words, one a line.
std::string words_of_task(const TempFolder& folder, const FarmJob& job, const std::string& index,
                          int expected_status = 0) {
    write_bytes(folder / "task", job.script);
    const Outcome outcome = run_other(
        folder, {"env", "SLURM_ARRAY_TASK_ID=" + index, "SLURM_CPUS_PER_TASK=3", "sh", "task"});
    EXPECT_EQ(outcome.status, expected_status) << outcome.err;
    return outcome.out;
}

void write_program(const std::string& path, const std::string& script) {
    write_bytes(path, script);
    ::chmod(path.c_str(), 0755);
}

TEST(Tasks, RunTheProgramWithTheUsersWordsAndTheirOwnFrames) {
    const TempFolder folder;
    FarmShot shot = a_shot();
    shot.program = folder / "the program";
    write_program(shot.program, "#!/bin/sh\nprintf '%s\\n' \"$@\"\n");
    const auto jobs = farm_jobs(farm_kind("slurm"), shot);
    const std::string head = "shot\np.####.exr\n-o\nq.####.exr\n--farm\nnone\n--stage\n";
    EXPECT_EQ(words_of_task(folder, jobs[0], "0"),
              head + "track\n--jobs\n3\n--frames\n1001-1023\n");
    EXPECT_EQ(words_of_task(folder, jobs[2], "3"),
              head + "convert\n--jobs\n3\n--frames\n1088-1100\n");
    EXPECT_EQ(words_of_task(folder, jobs[1], ""), head + "solve\n--jobs\n3\n--frames\n1001-1100\n");
    EXPECT_EQ(words_of_task(folder, jobs[3], ""),
              head + "report\n--jobs\n3\n--frames\n1001-1100\n--report=r.html\n");
    EXPECT_EQ(words_of_task(folder, jobs[0], "4", 1), "") << "no such chunk";
}

TEST(Tasks, GiveAnyWordOnAsItIs) {
    const TempFolder folder;
    FarmShot shot = a_shot();
    shot.program = folder / "it's $a program";
    write_program(shot.program, "#!/bin/sh\nprintf '%s\\0' \"$@\"\n");
    shot.words = {"shot"};
    std::string wanted = std::string("shot") + '\0';
    const std::string ours = "--farm none --stage track --jobs 5 --frames 1001-1023 ";
    for (const char c : ours) wanted += c == ' ' ? '\0' : c;
    shot.jobs = 5;
    shot.words.push_back("--");
    wanted += std::string("--") + '\0';
    for (const std::string& word : kNastyWords) {
        shot.words.push_back(word);
        wanted += word + '\0';
    }
    EXPECT_EQ(words_of_task(folder, farm_jobs(farm_kind("slurm"), shot)[0], "0"), wanted);
}

TEST(Tasks, OfTheSolvePassOverFailedFramesOnly) {
    const TempFolder folder;
    FarmShot shot = a_shot();
    shot.program = folder / "program";
    for (const auto& [theirs, ours] : {std::pair(0, 0), {3, 0}, {1, 1}, {2, 2}, {130, 130}}) {
        write_program(shot.program, "#!/bin/sh\nexit " + std::to_string(theirs) + "\n");
        const auto jobs = farm_jobs(farm_kind("slurm"), shot);
        words_of_task(folder, jobs[1], "", ours);
        words_of_task(folder, jobs[0], "0", theirs);
    }
}

/// A farm that takes every job, numbers them from 70 on and remembers.
struct Taken {
    std::vector<std::vector<std::string>> words;
    std::vector<std::string> scripts;
    RunProgram run = [this](const std::vector<std::string>& w, const std::string& script) {
        words.push_back(w);
        scripts.push_back(script);
        return ProgramOutcome{0, std::to_string(69 + words.size()) + ";cluster\n", ""};
    };
};

bool holds(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

TEST(Submission, TellsSlurmArraysAndWhatTheyWaitFor) {
    FarmShot shot = a_shot();
    shot.options = {"--partition=a b"};
    shot.jobs = 2;
    shot.logs = "/shots/100%/logs";
    const FarmKind& slurm = farm_kind("slurm");
    Taken farm;
    const auto numbers = submit(slurm, shot, farm_jobs(slurm, shot), farm.run);
    EXPECT_EQ(numbers, (std::vector<std::string>{"70", "71", "72", "73"}));
    ASSERT_EQ(farm.words.size(), 4u);
    for (const auto& words : farm.words) {
        EXPECT_EQ(words[0], "sbatch");
        EXPECT_EQ(words[1], "--parsable");
        EXPECT_TRUE(holds(words, "--chdir=/shots/10"));
        EXPECT_TRUE(holds(words, "--cpus-per-task=2"));
        EXPECT_TRUE(holds(words, "--partition=a b"));
    }
    EXPECT_TRUE(holds(farm.words[0], "--array=0-3"));
    EXPECT_TRUE(holds(farm.words[0], "--output=/shots/100%%/logs/%x.%A_%a.log"));
    EXPECT_TRUE(holds(farm.words[1], "--output=/shots/100%%/logs/%x.%j.log"));
    EXPECT_EQ(farm.words[1].back(), "--dependency=afterany:70");
    EXPECT_EQ(farm.words[2].back(), "--dependency=afterok:71");
    EXPECT_EQ(farm.words[3].back(), "--dependency=afterany:72");
}

std::string refusal(const RunProgram& run, FarmShot shot = a_shot()) {
    const FarmKind& slurm = farm_kind("slurm");
    try {
        submit(slurm, shot, farm_jobs(slurm, shot), run);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Submission, ThatIsRefusedTellsWhyAndWhatIsSubmittedAlready) {
    EXPECT_NE(refusal([](const auto&, const auto&) {
                  return ProgramOutcome{127, "", ""};
              }).find("sbatch took no job track: there is no such program"),
              std::string::npos);
    int calls = 0;
    const std::string second = refusal([&](const auto&, const auto&) {
        return ++calls == 1 ? ProgramOutcome{0, "12\n", ""}
                            : ProgramOutcome{1, "", "sbatch: error: limit\nmore\n"};
    });
    EXPECT_NE(second.find("no job solve: status 1, \"sbatch: error: limit\""), std::string::npos);
    EXPECT_NE(second.find("\"scancel 12\""), std::string::npos);
    EXPECT_NE(refusal([](const auto&, const auto&) {
                  return ProgramOutcome{0, "hello", ""};
              }).find("no job's number"),
              std::string::npos);
    FarmShot shot = a_shot();
    shot.logs = "/a\\b";
    EXPECT_NE(refusal(Taken().run, shot).find("--work"), std::string::npos);
}

TEST(Submission, ToAnUnknownFarmNamesTheKnownOnes) {
    try {
        farm_kind("slrum");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::usage);
        EXPECT_NE(std::string(error.what()).find("\"slurm\""), std::string::npos);
    }
}

TEST(ADryRun, RunThroughShSubmitsWhatASubmissionWould) {
    const TempFolder folder;
    FarmShot shot = a_shot();
    shot.folder = folder / "it's a $folder";
    shot.logs = folder / "logs of 'it'";
    shot.options = {"--comment=$(touch harm)"};
    shot.words.push_back("x\nSCRIPT\nCHUNKS\ny");
    const FarmKind& slurm = farm_kind("slurm");
    const auto jobs = farm_jobs(slurm, shot);
    Taken farm;
    submit(slurm, shot, jobs, farm.run);

    // An sbatch that writes down its words and its script.
    write_program(folder / "sbatch",
                  "#!/bin/sh\nn=$(($(cat count 2>/dev/null || echo 69) + 1))\necho $n >count\n"
                  "printf '%s\\0' \"$0\" \"$@\" >words.$n\ncat >script.$n\necho \"$n;cluster\"\n");
    write_bytes(folder / "dry", dry_run(slurm, shot, jobs));
    for (const char* shell : {"sh", "bash"}) {
        run_other(folder, {"rm", "-f", "count"});
        const Outcome outcome =
            run_other(folder, {"env", "PATH=" + folder.path() + ":/usr/bin:/bin", shell, "dry"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            const std::string n = std::to_string(70 + i);
            EXPECT_EQ(read_bytes(folder / ("script." + n)), farm.scripts[i]);
            std::string wanted;
            for (const std::string& word : farm.words[i])
                wanted += (word == "sbatch" ? folder / word : word) + '\0';
            EXPECT_EQ(read_bytes(folder / ("words." + n)), wanted);
        }
    }
    EXPECT_TRUE(exists(shot.logs));
    EXPECT_FALSE(exists(folder / "harm"));
}

TEST(RunProgram, GivesInputAndTakesOutputWithoutAShell) {
    const std::string much(1 << 20, 'x');
    const ProgramOutcome echoed = run_program({"cat"}, much);
    EXPECT_EQ(echoed.status, 0);
    EXPECT_EQ(echoed.out, much);
    EXPECT_EQ(run_program({"printf", "%s", "$(id) 'a'"}, "").out, "$(id) 'a'");
    const ProgramOutcome failed = run_program({"sh", "-c", "echo no >&2; exit 7"}, "");
    EXPECT_EQ(failed.status, 7);
    EXPECT_EQ(failed.err, "no\n");
    EXPECT_EQ(run_program({"sh", "-c", "kill -9 $$"}, "").status, 128 + 9);
    EXPECT_EQ(run_program({"no-such-program-anywhere"}, "").status, 127);
}

}  // namespace
}  // namespace chromeball::test
