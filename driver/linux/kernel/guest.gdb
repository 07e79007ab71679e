# For gdb on a guest's kernel that `hvp linux --gdb` has started: gdb -p PROCESS -x guest.gdb. The
# kernel's own commands (lx-…) are there then, and the module's types and lines as soon as it loads.

# What a kernel that is a process does all the time: faults of its programs, its timer, its wake-ups.
handle SIGSEGV SIGBUS SIGUSR1 SIGUSR2 SIGALRM SIGVTALRM SIGIO SIGCHLD SIGWINCH nostop noprint pass
# What it was held with until now.
handle SIGSTOP nostop noprint nopass
set breakpoint pending on
set follow-fork-mode parent

python
import os

_program = os.path.realpath("/proc/%d/exe" % gdb.selected_inferior().pid)
_folder = os.path.dirname(_program)
# By this name the kernel's own commands find it.
gdb.execute("file " + os.path.join(_folder, "vmlinux"))
gdb.execute("source " + os.path.join(_folder, "tree", "vmlinux-gdb.py"))
gdb.execute("lx-symbols " + os.path.join(_folder, "module"))
end
