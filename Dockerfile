# Slowdrift in one image: `slowdrift serve`, `slowdrift worker`, `slowdrift migrate` are its commands (docker-compose.yml).
FROM python:3.12-slim AS build
WORKDIR /src
COPY pyproject.toml README.md ./
COPY solver solver
COPY store store
COPY worker worker
COPY api api
COPY frontend frontend
COPY cli cli
COPY examples examples
RUN python -m venv /opt/slowdrift && /opt/slowdrift/bin/pip install --no-cache-dir .

FROM python:3.12-slim
RUN useradd --create-home --uid 10001 slowdrift && install -d -o slowdrift /data /cache
COPY --from=build /opt/slowdrift /opt/slowdrift
ENV PATH=/opt/slowdrift/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    OPENBLAS_NUM_THREADS=1 \
    OMP_NUM_THREADS=1 \
    NUMBA_CACHE_DIR=/cache \
    SLOWDRIFT_DATA_DIR=/data
USER slowdrift
# the kernels are compiled once, into the image
RUN python -c "import solver.run; solver.run.warm_up()"
WORKDIR /data
EXPOSE 8000
CMD ["slowdrift", "serve", "--host", "0.0.0.0", "--allow-no-login", "--log", "here"]
