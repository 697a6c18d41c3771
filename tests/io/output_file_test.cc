#include "io/output_file.h"
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class OutputFileTest : public ::testing::Test {
 protected:
  std::string CreateError(const std::filesystem::path& path) {
    const auto file = OutputFile::Create(path);
    return file.ok() ? "" : file.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(OutputFileTest, AppearsOnCommitWhole) {
  auto file = OutputFile::Create(folder_.path() / "new folder" / "a 'name'.txt");
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_TRUE(file->Write("hello ").ok());
  ASSERT_TRUE(file->Write("world").ok());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "new folder" / "a 'name'.txt"));
  ASSERT_TRUE(file->Commit().ok());
  EXPECT_EQ(folder_.Read("new folder/a 'name'.txt"), "hello world");
  EXPECT_FALSE(file->Write("more").ok());
}

TEST_F(OutputFileTest, WithoutCommitTheOldFileStays) {
  folder_.Write("result", "old");
  {
    auto file = OutputFile::Create(folder_.path() / "result");
    ASSERT_TRUE(file->Write(std::string(1 << 20, 'x')).ok());
    EXPECT_EQ(folder_.Names().size(), 2U);
  }
  EXPECT_THAT(folder_.Names(), ElementsAre("result"));
  EXPECT_EQ(folder_.Read("result"), "old");
}

TEST_F(OutputFileTest, MovedFilesAreStillOneFile) {
  auto first = OutputFile::Create(folder_.path() / "a");
  auto second = OutputFile::Create(folder_.path() / "b");
  *second = std::move(*first);  // b is given up
  ASSERT_TRUE(second->Write("a").ok());
  ASSERT_TRUE(second->Commit().ok());
  EXPECT_THAT(folder_.Names(), ElementsAre("a"));
}

TEST_F(OutputFileTest, RewritesWhatIsWritten) {
  auto file = OutputFile::Create(folder_.path() / "a");
  ASSERT_TRUE(file->Write("count: 000;").ok());
  ASSERT_TRUE(file->Rewrite(7, "123").ok());
  ASSERT_TRUE(file->Write(" end").ok());
  ASSERT_TRUE(file->Commit().ok());
  EXPECT_EQ(folder_.Read("a"), "count: 123; end");
}

TEST_F(OutputFileTest, RewritesNothingElse) {
  auto file = OutputFile::Create(folder_.path() / "a");
  ASSERT_TRUE(file->Write("123").ok());
  EXPECT_FALSE(file->Rewrite(2, "45").ok());
}

TEST_F(OutputFileTest, ReplacesTheFileBehindALink) {
  folder_.Write("target", "old");
  std::filesystem::create_symlink("target", folder_.path() / "link");
  ASSERT_TRUE(WriteFile(folder_.path() / "link", "new").ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder_.path() / "link"));
  EXPECT_EQ(folder_.Read("target"), "new");
}

TEST_F(OutputFileTest, AFolderAsTargetIsAnError) {
  EXPECT_EQ(CreateError(folder_.path()),
            folder_.path().string() + ": cannot be written: found a folder, expected a file");
  EXPECT_THAT(CreateError(folder_.path() / ""), EndsWith("found a folder, expected a file"));
}

TEST_F(OutputFileTest, ADeviceAsTargetIsAnErrorAndSurvives) {
  EXPECT_EQ(CreateError("/dev/null"), "/dev/null: cannot be written: found a device or a pipe, expected a file");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(OutputFileTest, AFileAsFolderIsAnError) {
  const auto file = folder_.Write("file", "");
  EXPECT_EQ(CreateError(file / "deep" / "a.txt"), (file / "deep" / "a.txt").string() + ": cannot be written: " +
                                                      file.string() + " is a file, expected a folder");
}

TEST_F(OutputFileTest, AnUnwritableFolderIsAnError) {
  const auto locked = folder_.path() / "locked";
  std::filesystem::create_directory(locked);
  std::filesystem::permissions(locked, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  constexpr uid_t kNobody = 65534;
  const bool root = ::geteuid() == 0;  // whom no permission stops
  if (root) {
    std::filesystem::permissions(locked, std::filesystem::perms::others_exec, std::filesystem::perm_options::add);
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  const std::string error = CreateError(locked / "a.txt");
  ASSERT_EQ(::seteuid(root ? 0 : ::geteuid()), 0);
  EXPECT_EQ(error, (locked / "a.txt").string() + ": cannot be written: Permission denied");
}

// Stands for a full disk: from then on write(2) fails as it does there.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  void (*handler_)(int) = SIG_DFL;
};

TEST_F(OutputFileTest, AFullDiskIsToldAndLeavesTheOldFile) {
  folder_.Write("result", "old");
  {
    const FileSizeLimit limit(1000);
    auto file = OutputFile::Create(folder_.path() / "result");
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->Write(std::string(2000, 'x')).ok());  // still in the buffer
    const auto result = file->Commit();
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().message, (folder_.path() / "result").string() + ": cannot be written: File too large");
    EXPECT_FALSE(file->Commit().ok());
  }
  EXPECT_THAT(folder_.Names(), ElementsAre("result"));
  EXPECT_EQ(folder_.Read("result"), "old");
}

TEST_F(OutputFileTest, AFullDiskIsToldByALargeWrite) {
  const FileSizeLimit limit(1000);
  auto file = OutputFile::Create(folder_.path() / "result");
  EXPECT_FALSE(file->Write(std::string(1 << 20, 'x')).ok());
}

// A program in the middle of writing, stopped by a signal: its exit and what it leaves behind.
int StopWhileWriting(const std::filesystem::path& path, int signal) {
  int ready[2] = {};
  EXPECT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    auto file = OutputFile::Create(path);
    const bool ok = file.ok() && file->Write(std::string(1 << 20, 'x')).ok();
    const char byte = ok ? 'y' : 'n';
    if (::write(ready[1], &byte, 1) != 1) ::_exit(3);
    for (;;) ::pause();
  }
  char byte = 0;
  EXPECT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'y');
  ::close(ready[0]);
  ::close(ready[1]);
  ::kill(child, signal);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

TEST_F(OutputFileTest, SignalsLeaveNothingBehindAndTheOldFile) {
  folder_.Write("result", "old");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = StopWhileWriting(folder_.path() / "result", signal);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_THAT(folder_.Names(), ElementsAre("result"));
  }
  EXPECT_EQ(folder_.Read("result"), "old");
}

TEST_F(OutputFileTest, WithoutItsHandlerASignalWouldLeaveTheFile) {  // so the test above can fail
  StopWhileWriting(folder_.path() / "result", SIGKILL);
  EXPECT_THAT(folder_.Names(), ElementsAre(HasSubstr(".scancal-")));
}

TEST_F(OutputFileTest, AForkedChildDoesNotRemoveItsParentsFile) {
  auto file = OutputFile::Create(folder_.path() / "result");
  ASSERT_TRUE(file->Write("whole").ok());
  const pid_t child = ::fork();
  if (child == 0) {
    std::raise(SIGTERM);
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
  ASSERT_TRUE(file->Commit().ok());
  EXPECT_EQ(folder_.Read("result"), "whole");
}

TEST_F(OutputFileTest, FilesMayBeWrittenSideBySide) {
  auto a = OutputFile::Create(folder_.path() / "a"), b = OutputFile::Create(folder_.path() / "b");
  ASSERT_TRUE(a->Write("1").ok() && b->Write("2").ok() && a->Commit().ok() && b->Commit().ok());
  EXPECT_THAT(folder_.Names(), UnorderedElementsAre("a", "b"));
  EXPECT_EQ(folder_.Read("b"), "2");
}

TEST_F(OutputFileTest, NamesAreNotUsedUp) {
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(WriteFile(folder_.path() / "a", "1").ok());
}

}  // namespace
}  // namespace scancal
