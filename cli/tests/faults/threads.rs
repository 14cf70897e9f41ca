//! Threads that the system does not start: fewer threads, and the same bytes.

use std::fs;

use crate::work::{JBT, Room, code, example, told, wanted};

/// A `pthread_create` that lets so many threads be there at once, as a limit of processes does. The system's
/// own limit does not hold for root.
const FEW: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

struct work { void *(*start)(void *); void *with; };
static atomic_int running;

static void *run(void *given) {
    struct work work = *(struct work *)given;
    free(given);
    void *result = work.start(work.with);
    atomic_fetch_sub(&running, 1);
    return result;
}

int pthread_create(pthread_t *thread, const pthread_attr_t *how, void *(*start)(void *), void *with) {
    int (*create)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *) =
        dlsym(RTLD_NEXT, "pthread_create");
    struct work *work = malloc(sizeof *work);
    if (atomic_fetch_add(&running, 1) >= atoi(getenv("MOST_THREADS"))) {
        atomic_fetch_sub(&running, 1);
        free(work);
        return EAGAIN;
    }
    work->start = start;
    work->with = with;
    return create(thread, how, run, work);
}
"#;

#[test]
fn few_threads_make_the_same_bytes() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    fs::write(room.path("few.c"), FEW).expect("a file");
    let built = room.shell("cc -shared -fPIC -o few.so few.c -ldl");
    assert_eq!(code(&built), 0, "{}", told(&built));
    let hero = example("hero");
    let part = |at: u32| format!("part \"p{at}\" {{ point {{ at ({at} 0 0) radius 2 }} }} ");
    fs::write(room.path("parts.jbt"), format!("jbt 1 {} {}", part(0), part(3))).expect("a file");
    for frame in 1..4 {
        fs::write(room.path(&format!("frame_{frame}.csv")), format!("x,y,z\n0,0,{frame}\n")).expect("a file");
    }
    let works = [
        format!("mesh {hero} --resolution 40 -o out.stl"),
        format!("render {hero} --size 64x48 -o out.png"),
        format!("sample {hero} --resolution 24 -o out.npy"),
        "mesh parts.jbt --parts --cell 0.2 -o out_{}.stl".to_owned(),
        "mesh frame_{}.csv --radius 1 --cell 0.2 -o out_{}.stl --jobs 2 --force".to_owned(),
    ];
    let bytes = || -> Vec<(String, Vec<u8>)> {
        let names = room.names().into_iter().filter(|name| name.starts_with("out"));
        let read = |name: String| {
            let path = room.path(&name);
            let bytes = fs::read(&path).expect("it is there");
            fs::remove_file(path).expect("it is ours");
            (name, bytes)
        };
        names.map(read).collect()
    };
    let (mut runs, mut fewer) = (0, 0);
    for work in works {
        let line = format!("$JBT {}", work.replace("{}", "'{}'"));
        let plain = room.shell(&format!("RAYON_NUM_THREADS=1 {line}"));
        assert_eq!(code(&plain), 0, "{work}: {}", told(&plain));
        let expected = bytes();
        assert!(!expected.is_empty(), "{work}");
        for most in 0..10 {
            let output = room
                .command("sh")
                .args(["-c", &line])
                .env("JBT", JBT)
                .env("RAYON_NUM_THREADS", "8")
                .env("MOST_THREADS", most.to_string())
                .env("LD_PRELOAD", room.path("few.so"))
                .output()
                .expect("a shell");
            assert_eq!(code(&output), 0, "{most} threads, {work}: {}", told(&output));
            assert!(bytes() == expected, "{most} threads make other bytes of {work}");
            fewer += u32::from(told(&output).contains("threads can be started"));
            runs += 1;
        }
    }
    println!("{runs} runs with 0 to 9 threads, the same bytes; {fewer} said that they had fewer of 8");
    assert!(fewer > 0);
}
