/// Read by ThreadSanitizer at the start of the process, meaningless otherwise. Cyclone DDS is not
/// instrumented: its atomic reference counts are not seen, but its calls of memcpy and free are,
/// which looks like races inside it. What Atrium does on the threads of both sides is still
/// checked.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() { return "called_from_lib:libddsc.so\n"; }
