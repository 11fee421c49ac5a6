/* torsionbook.exe: the command line in the Python beside it, with the words, the console and the exit status as they are.
   Built by scripts/zips.py. */
#include <windows.h>

#define ROOM 32768 /* Windows allows a command line no more. */

static WCHAR line[ROOM], place[ROOM];

static BOOL WINAPI left_to_python(DWORD event) { return event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT; }

/* Where the first word of the command line, which names this program, ends. */
static const WCHAR *after_program(const WCHAR *c) {
    int quoted = 0;
    for (; *c && (quoted || (*c != ' ' && *c != '\t')); c++)
        if (*c == '"') quoted = !quoted;
    return c;
}

static DWORD failed(const char *sentence) {
    DWORD written;
    WriteFile(GetStdHandle(STD_ERROR_HANDLE), sentence, lstrlenA(sentence), &written, NULL);
    return 3;
}

int main(void) {
    STARTUPINFOW start = {.cb = sizeof start};
    PROCESS_INFORMATION child;
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits = {0};
    DWORD status = 3, length = GetModuleFileNameW(NULL, place, ROOM);
    const WCHAR *words = after_program(GetCommandLineW());
    HANDLE job;
    while (length && place[length - 1] != '\\') length--;
    place[length] = 0;
    if (length + lstrlenW(words) + 64 > ROOM) return failed("The command line is too long.\r\n");
    lstrcpyW(line, L"\"");
    lstrcatW(line, place);
    lstrcatW(line, L"python\\python.exe\" -m addin.cli");
    lstrcatW(line, words);
    lstrcatW(place, L"python\\python.exe");
    SetConsoleCtrlHandler(left_to_python, TRUE);
    /* Whoever ends this program ends Python too. */
    job = CreateJobObjectW(NULL, NULL);
    limits.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
    SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits);
    GetStartupInfoW(&start); /* the handles of a redirected console */
    if (!CreateProcessW(place, line, NULL, NULL, TRUE, CREATE_SUSPENDED, NULL, NULL, &start, &child))
        return failed("The folder python beside this program is missing or damaged: unpack the zip again.\r\n");
    AssignProcessToJobObject(job, child.hProcess);
    ResumeThread(child.hThread);
    WaitForSingleObject(child.hProcess, INFINITE);
    GetExitCodeProcess(child.hProcess, &status);
    return (int)status;
}
